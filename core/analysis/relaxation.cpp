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
/// Where what a step leaves of the forces, by K, is this share of them, the step is nearly Newton's.
constexpr double nearly_newton = 1e-3;
/// The same of 1/step beside the greatest stiffness: less is not seen in sums of both.
constexpr double least_seen = 1e-15;
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
/// \returns the part of the displacement that was taken; 0 where they reach none
double take(const TangentDynamics& dynamics, State& state, const Eigen::VectorXd& displacement) {
  constexpr double least_part = 1e-6;
  for (double part = 1; part > least_part; part *= 0.5) {
    State there = state;
    dynamics.displace(there.y, part * displacement);
    if (std::any_of(there.y.begin(), there.y.end(), [](double y) { return std::isnan(y); })) continue;
    state = std::move(there);
    return part;
  }
  return 0;
}

/// What becomes of 1/step as the forces are followed: it falls as they do, and fast where K foretells how they change,
/// as in a fall under gravity that is long as against what stiffness allows and has the same forces all the way.
class Slowness {
 public:
  explicit Slowness(double first) : value_(first) {}
  [[nodiscard]] double value() const { return value_; }
  /// \param foretold the forces after the step, by those before it and K
  void follow(const Eigen::VectorXd& before, const Eigen::VectorXd& foretold, const Eigen::VectorXd& forces) {
    const double misfit = (forces - foretold).norm();
    value_ *= misfit <= as_foretold * before.norm() ? fastest_fall
                                                    : std::clamp(forces.norm() / before.norm(), fastest_fall, 2.0);
  }

 private:
  static constexpr double fastest_fall = 0.1;
  static constexpr double as_foretold = 0.1;
  double value_;
};

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
  std::optional<Slowness> slowness;
  Eigen::VectorXd before, foretold;  // forces
  for (; found.steps < most_relaxations; ++found.steps) {
    if (!here.look(found.state)) return {};
    if (slowness)
      slowness->follow(before, foretold, here.forces);
    else
      slowness.emplace(std::max(here.greatest, turn_of(here.in_own_units(here.forces)) / longest_turn));
    const double added = here.stable() ? slowness->value() : std::max(slowness->value(), -2 * here.least);
    here.K.diagonal().array() += added;
    const Eigen::VectorXd step = -here.K.partialPivLu().solve(here.forces);
    if (!step.allFinite()) return {};
    const double turn = turn_of(here.in_own_units(step));
    const bool newton =
        added * step.norm() <= nearly_newton * here.forces.norm() || added <= least_seen * here.greatest;
    if (here.stable() && newton && turn < longest_turn) return found;
    const double part = std::min(1.0, longest_turn / std::max(turn, longest_turn));
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    moved(free) = part * here.in_own_units(step);
    const double taken = part * take(dynamics, found.state, moved);
    if (taken == 0) return {};
    before = here.forces;
    foretold = (1 - taken) * before - taken * added * step;  // K step = −forces − added step
  }
  return {};
}

}  // namespace withy
