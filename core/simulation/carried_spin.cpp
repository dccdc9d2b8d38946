#include "withy/core/simulation/carried_spin.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace withy {
namespace {

/// About the centre of mass, undeformed.
Matrix3 inertia_of(const ModalShape& shape) {
  double mass = 0;
  Vector3 moment = Vector3::Zero();
  for (const Particle& p : shape.particles) mass += p.mass, moment += p.mass * p.at.X;
  const Vector3 centre = mass > 0 ? Vector3(moment / mass) : moment;
  Matrix3 inertia = Matrix3::Zero();
  for (const Particle& p : shape.particles) {
    const Vector3 r = p.at.X - centre;
    inertia += p.mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  }
  for (const withy::Section& s : shape.sections) inertia += s.inertia;
  return inertia;
}

}  // namespace

CarriedSpin::CarriedSpin(const Model& model)
    : model_(model),
      sections_(model.bodies().size()),
      inertia_(model.bodies().size(), Matrix3::Zero()),
      momentum_(model.bodies().size(), Vector3::Zero()) {
  for (const BodyNode& node : model.bodies()) own_.push_back(inertia_of(node.body->shape()));
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const int parent = model.hinges()[b].parent;
    if (parent < 0) continue;
    const BodyNode& node = model.bodies()[static_cast<std::size_t>(parent)];
    const ModalShape& shape = node.body->shape();
    if (shape.modes() == 0) continue;
    const Eigen::LLT<Eigen::MatrixXd> factors(shape.stiffness);
    if (factors.info() != Eigen::Success) continue;
    const Matrix3X& psi = node.frames[static_cast<std::size_t>(model.hinges()[b].parent_frame)].section.psi;
    sections_[static_cast<std::size_t>(parent)].push_back({b, psi * factors.solve(psi.transpose())});
  }
}

void CarriedSpin::update(const std::vector<BodyMotion>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    inertia_[b] = bodies[b].R * own_[b] * bodies[b].R.transpose();
    momentum_[b] = inertia_[b] * bodies[b].rate;
  }
  for (std::size_t b = bodies.size(); b-- > 0;) {
    const int parent = model_.hinges()[b].parent;
    if (parent < 0) continue;
    inertia_[static_cast<std::size_t>(parent)] += inertia_[b];
    momentum_[static_cast<std::size_t>(parent)] += momentum_[b];
  }
}

double CarriedSpin::ratio(std::size_t body, const std::vector<BodyMotion>& bodies, double frequency) const {
  double greatest = 0;
  for (const Section& section : sections_[body]) {
    const Vector3 spin = momentum_[section.carried] - inertia_[section.carried] * bodies[body].rate;
    const Vector3 h = bodies[body].R.transpose() * spin;
    Matrix3 across;
    for (int i = 0; i < 3; ++i) across.col(i) = h.cross(section.compliance.col(i));
    Eigen::SelfAdjointEigenSolver<Matrix3> squares;
    squares.computeDirect(Matrix3(across.transpose() * across), Eigen::EigenvaluesOnly);
    greatest = std::max(greatest, frequency * std::sqrt(std::max(squares.eigenvalues().maxCoeff(), 0.0)));
  }
  return greatest;
}

}  // namespace withy
