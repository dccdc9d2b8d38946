#include "withy/study/effective_mass.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/core/analysis/turn.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/study/refusals.hpp"

namespace withy::study {
namespace {

/// Momentum of unit speeds of what is free along the world's axes: it is linear in the speeds.
Eigen::MatrixX3d momenta_at(const Configuration& c, const State& at, const std::vector<Eigen::Index>& free) {
  const auto seen = c.prepared().equations->make_observation();
  Eigen::MatrixX3d P(static_cast<Eigen::Index>(free.size()), 3);
  std::vector<double> y = at.y;
  const auto n = static_cast<Eigen::Index>(c.layout().speeds);
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    Eigen::Map<Eigen::VectorXd>(y.data() + c.layout().positions, n) =
        c.dynamics().whole(at.y, Eigen::VectorXd::Unit(n, free[static_cast<std::size_t>(i)]));
    seen->observe(y);
    P.row(i) = Eigen::Map<const Eigen::RowVector3d>(seen->energies().linear_momentum.data());
  }
  return P;
}

/// Whether they are others as hinges go on that move, beyond rounding.
bool momenta_turn(const Configuration& c, const Eigen::MatrixX3d& P, const std::vector<Eigen::Index>& free) {
  constexpr double rounding = 1e-9;
  const Turning turned = turning(c.prepared().model(), c.state());
  double over = turned.period;
  for (const std::size_t s : turned.speeds)
    if (!(turned.period > 0)) over = std::max(over, full_turn / std::abs(c.state().y[c.layout().positions + s]));
  for (const double share : in_no_ratio) {
    const Eigen::MatrixX3d there = momenta_at(c, carried(c.prepared().model(), turned, c.state(), share * over), free);
    if ((there - P).cwiseAbs().maxCoeff() > rounding * P.cwiseAbs().maxCoeff()) return true;
  }
  return false;
}

}  // namespace

EffectiveMasses effective_masses(const Configuration& c) {
  refuse_states_of_loads(c.prepared(), "--effective-mass");
  EffectiveMasses result;
  for (const BodyNode& body : c.prepared().model().bodies())
    for (const Particle& p : body.body->shape().particles) result.total += p.mass;
  const std::vector<Eigen::Index> free = free_speeds(c.held());
  const auto n = static_cast<Eigen::Index>(free.size());
  result.participation.resize(3, n);
  if (n == 0) return result;

  const Eigen::MatrixX3d P = momenta_at(c, c.state(), free);
  result.turning = momenta_turn(c, P, free);
  const Tangents t = c.dynamics().tangents(c.state().time, c.state().y, accelerations_of(c));
  const Eigen::MatrixXd M = t.mass(free, free), K = t.by_position(free, free);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (K + K.transpose()),
                                                                        0.5 * (M + M.transpose()));
  if (modes.info() != Eigen::Success)
    throw std::domain_error("the mass matrix of what is free is not positive at this state");
  // Shapes are scaled to φᵀ M φ = 1.
  result.participation = P.transpose() * modes.eigenvectors();
  result.frequencies =
      modes.eigenvalues().unaryExpr([](double square) { return square < 0 ? -std::sqrt(-square) : std::sqrt(square); });
  return result;
}

}  // namespace withy::study
