#include "withy/core/analysis/relaxation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/core/analysis/scaled_problem.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

constexpr int most_relaxations = 100;
constexpr std::size_t most_free = 300;  ///< of which eigenvalues are found in each step
constexpr double longest_turn = 0.3;    ///< [rad] of a step
/// Where 1/step is this share of the greatest stiffness, the step is nearly Newton's.
constexpr double nearly_newton = 1e-3;
/// Eigenvalues of K below this share of the greatest are rounding.
constexpr double rounding = 1e-9;

/// The free coordinates about a state, in units in which M_ii is 1.
class Free {
 public:
  Free(const TangentDynamics& dynamics, const State& state, const std::vector<Eigen::Index>& free)
      : dynamics_(dynamics),
        free_(free),
        rest_(dynamics.steady_accelerations(state.time)),
        unit_(unit_inertias(dynamics.mass(state.time, state.y).diagonal()(free))) {}
  /// \returns whether all is finite.
  bool look(const State& state) {
    const Stiffness t = dynamics_.stiffness(state.time, state.y, rest_);
    forces = unit_.cwiseProduct(t.residual(free_));
    K = unit_.asDiagonal() * t.by_position(free_, free_) * unit_.asDiagonal();
    if (!forces.allFinite() || !K.allFinite()) return false;
    const Eigen::MatrixXd symmetric = 0.5 * (K + K.transpose());
    const Eigen::VectorXd stiffness =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
    least = stiffness.minCoeff(), greatest = stiffness.cwiseAbs().maxCoeff();
    return true;
  }
  [[nodiscard]] bool stable() const { return least >= -rounding * greatest; }
  [[nodiscard]] Eigen::VectorXd in_own_units(const Eigen::VectorXd& scaled) const { return unit_.cwiseProduct(scaled); }

  Eigen::VectorXd forces;
  Eigen::MatrixXd K;
  double least = 0, greatest = 0;  ///< eigenvalues of the symmetric part of K

 private:
  const TangentDynamics& dynamics_;
  const std::vector<Eigen::Index>& free_;
  Eigen::VectorXd rest_, unit_;
};

/// Of the free speeds those that turn something.
std::vector<Eigen::Index> turning(const Model& model, const std::vector<Eigen::Index>& free) {
  std::vector<bool> angular(model.layout().speeds);
  for (const ModelRate& rate : hinge_rates(model)) angular[rate.speed] = rate.angular;
  std::vector<Eigen::Index> found;
  for (std::size_t k = 0; k < free.size(); ++k)
    if (angular[static_cast<std::size_t>(free[k])]) found.push_back(static_cast<Eigen::Index>(k));
  return found;
}

/// Moves by a displacement or, where closed loops do not reach so far, by the half that they do reach.
/// \returns whether they reach any
bool take(const TangentDynamics& dynamics, State& state, Eigen::VectorXd displacement) {
  constexpr int most_halves = 20;
  for (int halves = 0; halves < most_halves; ++halves, displacement *= 0.5) {
    State there = state;
    dynamics.displace(there.y, displacement);
    if (std::any_of(there.y.begin(), there.y.end(), [](double y) { return std::isnan(y); })) continue;
    state = std::move(there);
    return true;
  }
  return false;
}

}  // namespace

bool lasts(const TangentDynamics& dynamics, const State& state, const Held& held) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return true;
  Free here(dynamics, state, free);
  return here.look(state) && here.stable();
}

std::optional<Relaxation> relaxed(const TangentDynamics& dynamics, const State& start, const Held& held) {
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty() || free.size() > most_free) return {};
  const std::vector<Eigen::Index> angles = turning(dynamics.model(), free);
  const auto turn_of = [&angles](const Eigen::VectorXd& v) {
    return angles.empty() ? 0.0 : v(angles).cwiseAbs().maxCoeff();
  };
  Free here(dynamics, start, free);
  Relaxation found{start};
  double slowness = 0, before = 0;  // 1/step; size of the forces
  for (; found.steps < most_relaxations; ++found.steps) {
    if (!here.look(found.state)) return {};
    const double size = here.forces.norm();
    slowness = found.steps == 0 ? std::max(here.greatest, turn_of(here.in_own_units(here.forces)) / longest_turn)
                                : slowness * std::clamp(size / before, 0.1, 2.0);
    before = size;
    here.K.diagonal().array() += here.stable() ? slowness : std::max(slowness, -2 * here.least);
    const Eigen::VectorXd step = -here.in_own_units(here.K.partialPivLu().solve(here.forces));
    if (!step.allFinite()) return {};
    const double turn = turn_of(step);
    if (here.stable() && slowness <= nearly_newton * here.greatest && turn < longest_turn) return found;
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    moved(free) = step * std::min(1.0, longest_turn / std::max(turn, longest_turn));
    if (!take(dynamics, found.state, moved)) return {};
  }
  return {};
}

}  // namespace withy
