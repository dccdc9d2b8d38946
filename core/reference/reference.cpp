#include "withy/core/reference/reference.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/reference/first_order_energy.hpp"
#include "withy/core/reference/reference_tree.hpp"

namespace withy {
namespace {

using reference::BodyTerms;
using reference::MX;
using reference::PlacedWrench;
using reference::VX;
using reference::WorldMotion;

/// a + εb with ε² = 0.
using Dual = DualNumber<double, 1>;

/// M u̇ = f + applied, before stiffness and damping of bodies.
struct Assembled {
  Eigen::MatrixXd M;
  Eigen::VectorXd f, applied;
};

/// Theory (3): the directional derivative along the elastic coordinates is the dual part.
/// \param all one a body
Assembled strict_system(const Model& model, const std::vector<Terms>& all, std::span<const double> y,
                        const std::vector<PlacedWrench>& wrenches) {
  Dual epsilon(0.0);
  epsilon.derivatives()[0] = 1.0;
  MX<Dual> dual_mass;
  VX<Dual> dual_force;
  std::vector<BodyTerms<Dual>> terms;
  for (const Terms& own : all)
    terms.push_back({own.strain, own.truncation == Truncation::ruthless ? Dual(0.0) : epsilon});
  const reference::ReferenceTree<Dual> tree(model, std::move(terms), y);
  tree.assemble(dual_mass, dual_force);
  VX<Dual> dual_applied = VX<Dual>::Zero(static_cast<Eigen::Index>(model.layout().speeds));
  for (const auto& [at, wrench] : wrenches) tree.add_efforts(at, wrench, dual_applied);
  const auto value = [](const Dual& d) { return d.value(); };
  const auto first = [](const Dual& d) { return d.derivatives()[0]; };
  Assembled s;
  s.applied = dual_applied.unaryExpr(value) + dual_applied.unaryExpr(first);
  s.M = dual_mass.unaryExpr(value);
  const Eigen::MatrixXd M1 = dual_mass.unaryExpr(first);
  s.f = dual_force.unaryExpr(value) + dual_force.unaryExpr(first);
  for (const Slot& hinge : model.layout().hinges) {
    const auto at = static_cast<Eigen::Index>(hinge.speed);
    const auto count = static_cast<Eigen::Index>(hinge.speeds);
    s.M.middleCols(at, count) += M1.middleCols(at, count);
  }
  return s;
}

/// Without truncation, or with deformations left out of M and f.
/// \param all one a body \param rods one a body, null where it is no rod of exact kinematics
Assembled whole_system(const Model& model, const std::vector<Terms>& all,
                       const std::vector<std::shared_ptr<const RodTable>>& rods, std::span<const double> y,
                       const std::vector<PlacedWrench>& wrenches) {
  std::vector<BodyTerms<double>> terms;
  for (std::size_t b = 0; b < all.size(); ++b)
    terms.push_back({all[b].strain, all[b].truncation == Truncation::ruthless ? 0.0 : 1.0, rods[b].get()});
  const reference::ReferenceTree<double> tree(model, std::move(terms), y);
  Assembled s;
  tree.assemble(s.M, s.f);
  s.applied = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.layout().speeds));
  for (const auto& [at, wrench] : wrenches) tree.add_efforts(at, wrench, s.applied);
  return s;
}

/// f −= K q + D q̇ of every body.
void add_elastic_forces(const Model& model, std::span<const double> y, Eigen::VectorXd& f) {
  const Layout& layout = model.layout();
  std::size_t flexible = 0;
  for (const BodyNode& node : model.bodies()) {
    const ModalShape& shape = node.body->shape();
    if (shape.modes() == 0) continue;
    const Slot& slot = layout.bodies[flexible++];
    const Eigen::Map<const Eigen::VectorXd> q(y.data() + slot.position, shape.modes());
    const Eigen::Map<const Eigen::VectorXd> q_dot(y.data() + layout.positions + slot.speed, shape.modes());
    f.segment(static_cast<Eigen::Index>(slot.speed), shape.modes()) -= shape.stiffness * q + shape.damping * q_dot;
  }
}

std::vector<PrescribedRate> prescribed_at(const Model& model, double t, std::span<const double> y) {
  std::vector<PrescribedRate> prescribed;
  std::vector<double> u_dot(model.layout().speeds);
  model.prescribe_accelerations(t, u_dot);
  HostedMotions(model).prescribe(t, y, u_dot);
  for (const MotionNode& node : model.motions()) {
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(node.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i) prescribed.push_back({slot.speed + i, u_dot[slot.speed + i]});
  }
  return prescribed;
}

}  // namespace

ReferenceDynamics::ReferenceDynamics(std::shared_ptr<const Model> model, Terms terms)
    : model_(std::move(model)), terms_(terms) {
  model_->require_rods(terms);
  for (std::size_t b = 0; b < model_->bodies().size(); ++b) {
    slots_.push_back(model_->layout().modes(b));
    rods_.emplace_back();
    if (model_->is_exact(b, terms)) rods_.back() = std::make_shared<const RodTable>(*model_->bodies()[b].body->rod());
  }
}

Terms ReferenceDynamics::terms_of(std::size_t body) const { return model_->bodies()[body].terms.value_or(terms_); }

DenseSystem ReferenceDynamics::system(double t, std::span<const double> y) const {
  const Layout& layout = model_->layout();
  const std::vector<PlacedWrench> wrenches = wrenches_at(t, y);
  std::vector<Terms> terms;
  for (std::size_t b = 0; b < model_->bodies().size(); ++b) terms.push_back(terms_of(b));
  const auto any = [&](Truncation truncation) {
    bool found = false;
    for (std::size_t b = 0; b < terms.size(); ++b)
      found = found || (slots_[b] != nullptr && terms[b].truncation == truncation);
    return found;
  };
  Assembled all;
  if (any(Truncation::symmetric)) {
    reference::FirstOrderSystem first_order = reference::first_order_system(*model_, terms, y, wrenches);
    all = {std::move(first_order.M), std::move(first_order.f), std::move(first_order.applied)};
  } else if (any(Truncation::strict)) {
    all = strict_system(*model_, terms, y, wrenches);
  } else {
    std::vector<double> seen(y.begin(), y.end());
    if (!terms_.products_of_speeds) {
      const auto first = seen.begin() + static_cast<std::ptrdiff_t>(layout.positions);
      std::fill(first, first + static_cast<std::ptrdiff_t>(layout.speeds), 0.0);
    }
    all = whole_system(*model_, terms, rods_, seen, wrenches);
  }
  add_elastic_forces(*model_, y, all.f);
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const auto rate = static_cast<Eigen::Index>(layout.hinges[h].speed);
    if (layout.hinges[h].speeds == 1) all.M(rate, rate) += model_->hinges()[h].reflected_inertia;
  }

  const auto n = static_cast<Eigen::Index>(layout.speeds);
  DenseSystem s;
  s.size = layout.speeds;
  s.mass.resize(s.size * s.size);
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(s.mass.data(), n, n) = all.M;
  s.force.assign(all.f.data(), all.f.data() + n);
  s.applied.assign(all.applied.data(), all.applied.data() + n);
  s.prescribed = prescribed_at(*model_, t, y);
  std::vector<double> scratch(model_->load_scratch());
  for (const LoadNode& node : model_->loads())
    node.load->add(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), s.applied, scratch);
  model_->add_state_efforts(t, y, s.applied, scratch);
  return s;
}

std::vector<PlacedWrench> ReferenceDynamics::wrenches_at(double t, std::span<const double> y) const {
  std::vector<BodyTerms<double>> terms;
  for (std::size_t b = 0; b < model_->bodies().size(); ++b)
    terms.push_back({terms_of(b).strain, terms_of(b).truncation == Truncation::ruthless ? 0.0 : 1.0, rods_[b].get()});
  const reference::ReferenceTree<double> tree(*model_, std::move(terms), y);
  std::vector<PlacedWrench> all;
  std::vector<double> scratch(model_->load_scratch());
  for (const LoadNode& node : model_->loads()) {
    std::vector<FrameMotion> motions;
    for (const FrameIndex& at : node.load->frames()) {
      const WorldMotion<double> A = tree.frame(at.body, at.frame, Pose{});
      motions.push_back({A.R, A.p, A.w, A.v});
    }
    std::vector<Wrench> wrenches(motions.size());
    node.wrenches(t, y, model_->layout(), motions, wrenches, scratch);
    for (std::size_t i = 0; i < wrenches.size(); ++i) all.push_back({node.load->frames()[i], wrenches[i]});
  }
  return all;
}

reference::ReferenceTree<double> ReferenceDynamics::untruncated(std::span<const double> y) const {
  std::vector<BodyTerms<double>> terms;
  for (std::size_t b = 0; b < model_->bodies().size(); ++b) terms.push_back({terms_of(b).strain, 1.0, rods_[b].get()});
  return {*model_, std::move(terms), y};
}

Energies ReferenceDynamics::energies(std::span<const double> y) const {
  Energies e = untruncated(y).energies();
  const Layout& layout = model_->layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h)
    if (layout.hinges[h].speeds == 1)
      e.kinetic +=
          0.5 * model_->hinges()[h].reflected_inertia * std::pow(y[layout.positions + layout.hinges[h].speed], 2);
  return e;
}

WorldPose ReferenceDynamics::frame_pose(std::span<const double> y, int body, int frame) const {
  const WorldMotion<double> A = untruncated(y).frame(body, frame, Pose{});
  WorldPose pose;
  Eigen::Map<Vector3>(pose.position.data()) = A.p;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()) = A.R;
  return pose;
}

std::array<double, 3> ReferenceDynamics::deflection(std::span<const double> y, int body, int frame) const {
  const auto b = static_cast<std::size_t>(body);
  const BodyNode& node = model_->bodies()[b];
  std::array<double, 3> d{};
  if (node.body->shape().modes() == 0) return d;
  const PointExpansion& e = node.frames[static_cast<std::size_t>(frame)].section;
  const Slot& slot = *slots_[b];
  const Eigen::Map<const Eigen::VectorXd> q(y.data() + slot.position, node.body->shape().modes());
  const Vector3 r = rods_[b] != nullptr ? RodMotion::position(*rods_[b], q, e.X.x())
                                        : point_velocity(e, terms_of(b).strain, q, q).first;
  Eigen::Map<Vector3>(d.data()) = r - e.X;
  return d;
}

}  // namespace withy
