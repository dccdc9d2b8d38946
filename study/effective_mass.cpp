#include "withy/study/effective_mass.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "withy/core/plugin/equations.hpp"
#include "withy/study/states_of_loads.hpp"

namespace withy::study {

EffectiveMasses effective_masses(const Configuration& c) {
  refuse_states_of_loads(c.prepared(), "--effective-mass");
  EffectiveMasses result;
  for (const BodyNode& body : c.prepared().model().bodies())
    for (const Particle& p : body.body->shape().particles) result.total += p.mass;
  const std::vector<Eigen::Index> free = free_speeds(c.held());
  const auto n = static_cast<Eigen::Index>(free.size());
  result.participation.resize(3, n);
  if (n == 0) return result;

  // Momentum is linear in the speeds.
  const auto seen = c.prepared().equations->make_observation();
  Eigen::MatrixX3d P(n, 3);
  std::vector<double> y = c.state().y;
  const auto speeds = y.begin() + static_cast<std::ptrdiff_t>(c.layout().positions);
  std::fill(speeds, speeds + static_cast<std::ptrdiff_t>(c.layout().speeds), 0.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    speeds[free[static_cast<std::size_t>(i)]] = 1;
    seen->observe(y);
    P.row(i) = Eigen::Map<const Eigen::RowVector3d>(seen->energies().linear_momentum.data());
    speeds[free[static_cast<std::size_t>(i)]] = 0;
  }
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
