#include "withy/core/analysis/steady_state.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "withy/core/analysis/relaxation.hpp"
#include "withy/core/analysis/scaled_problem.hpp"
#include "withy/core/analysis/sliding.hpp"
#include "withy/core/analysis/unheld.hpp"
#include "withy/core/analysis/unreached.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

constexpr int most_iterations = 100;
/// A step this small against the coordinates and what they have moved is rounding.
constexpr double converged_step = 1e-11;
/// The same of a state that somebody gives.
constexpr double typed_share = 1e-9;
/// Who starts as near as this [rad] to a balance means that one, though it may not last, as of an upright pendulum.
constexpr double near = 0.5;
double greatest(const Eigen::VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }

class Newton {
 public:
  /// From a state in which no mode moves.
  Newton(const TangentDynamics& dynamics, const State& start, const Held& held)
      : dynamics_(dynamics),
        free_(free_speeds(held)),
        n_(static_cast<Eigen::Index>(held.size())),
        state_(start),
        rest_(dynamics.steady_accelerations(start.time)),
        mass_(dynamics.mass(state_.time, state_.y).diagonal()),
        scaled_(mass_(free_)) {}

  SteadyState solve() {
    SteadyState result;
    double moved = 0, before = std::numeric_limits<double>::infinity();  // before: size of the step before
    Eigen::VectorXd changed = Eigen::VectorXd::Zero(states().size());
    for (; result.iterations < most_iterations; ++result.iterations) {
      const Stiffness t = dynamics_.stiffness(state_.time, state_.y, rest_);
      const Imbalance left{t.residual, dynamics_.rates(state_.time, state_.y, rest_)};
      result.efforts = left.forces, result.rates = left.rates;
      result.step = rest_ * 0;
      // Nothing is free to change.
      if (free_.empty() && left.rates.size() == 0) {
        result.converged = left.forces.allFinite();
        break;
      }
      if (!factorize(t)) break;
      const Change step = solve_for(left);
      result.step = step.moved;
      if (!step.finite()) break;
      if (settled(step, converged_step, moved, changed)) {
        // The least-squares step may be zero where the residual is not: nothing can balance it.
        result.converged = balanced(left);
        break;
      }
      // Near a balance steps shrink with their square, until rounding is all that is left over: of forces that make up
      // for each other about coordinates of zero it moves these by more than a share of nothing.
      const double now = scaled_.norm(step, free_);
      const bool shrinks = now <= 0.25 * before;
      before = now;
      const double length = shrinks || !rounding(left) ? advance(step) : 0.0;
      if (length == 0) {
        result.converged = rounding(left) && balanced(left);
        break;
      }
      moved += length * greatest(step.moved);
      changed += length * step.states.cwiseAbs();
    }
    result.state = state_;
    if (singular_) result.neutral = neutral({result.efforts, result.rates});
    return result;
  }

  bool solved() {
    const Imbalance left{dynamics_.residual(state_.time, state_.y, rest_),
                         dynamics_.rates(state_.time, state_.y, rest_)};
    if (free_.empty() && left.rates.size() == 0) return left.forces.allFinite();
    if (!factorize(dynamics_.stiffness(state_.time, state_.y, rest_))) return false;
    const Change step = solve_for(left);
    return step.finite() && settled(step, typed_share, 0, Eigen::VectorXd::Zero(step.states.size())) && balanced(left);
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> states() const {
    const Layout& layout = dynamics_.model().layout();
    return {state_.y.data() + layout.positions + layout.speeds, static_cast<Eigen::Index>(layout.continuous)};
  }
  bool factorize(const Stiffness& t) {
    matrix_ = scaled_.matrix(t, free_);
    singular_ = false;
    if (!matrix_.allFinite()) return false;
    const Eigen::VectorXd in_play = dynamics_.stiffness_in_play(state_.time, state_.y, rest_, t.diagonal_terms, mass_);
    if (!in_play.allFinite()) return false;
    solver_ = GradedMatrix(matrix_, scaled_.floor(in_play, free_));
    singular_ = solver_.missing() > 0;
    return true;
  }
  /// A unit vector of displacements that nothing holds; empty where a state of a load is all that is free.
  [[nodiscard]] Eigen::VectorXd neutral(const Imbalance& left) const {
    const Eigen::VectorXd direction = along_unheld(solver_.unheld(), scaled_.right(left, free_));
    const Eigen::VectorXd moved = scaled_.change(direction, free_, n_).moved;
    return moved.norm() > 0 ? Eigen::VectorXd(moved / moved.norm()) : Eigen::VectorXd();
  }
  [[nodiscard]] Change solve_for(const Imbalance& left) const {
    const Eigen::VectorXd least = solver_.solve(scaled_.right(left, free_));
    return scaled_.change(-least, free_, n_);
  }
  /// Whether a step is such a share of the coordinates and what they have moved, and of the states likewise.
  [[nodiscard]] bool settled(const Change& step, double share, double moved, const Eigen::VectorXd& changed) const {
    if (greatest(step.moved) > share * (moved + size())) return false;
    const Eigen::VectorXd sizes = states().cwiseAbs() + changed + scaled_.states_like(size());
    return (step.states.array().abs() <= share * sizes.array()).all();
  }
  /// What the terms of what is left over amount to, in the units of the problem.
  [[nodiscard]] Eigen::VectorXd in_play(const Imbalance& left) const {
    Eigen::VectorXd all = scaled_.right({dynamics_.terms_in_play(state_.time, state_.y, rest_), 0 * left.rates}, free_);
    // Of rates that depend on nothing none is small.
    all.tail(left.rates.size()) =
        matrix_.bottomRows(left.rates.size()).cwiseAbs() * scaled_.sizes(size(), states().cwiseAbs());
    return all;
  }
  /// Whether data that are typed with some digits could balance.
  [[nodiscard]] bool balanced(const Imbalance& left) const {
    const Eigen::VectorXd scaled = scaled_.right(left, free_);
    if (!singular_) return scaled.allFinite();
    return reaches(solver_.unreached(), scaled, in_play(left));
  }
  /// Whether what is left over is what rounding leaves of the terms in it: no step makes it less.
  [[nodiscard]] bool rounding(const Imbalance& left) const {
    const double share = rounding_of_sums(dynamics_.model().bodies().size());
    return (scaled_.right(left, free_).array().abs() <= share * in_play(left).array()).all();
  }
  /// The part of the step that is taken: 0 where none makes the next one smaller.
  double advance(const Change& step) {
    const double size = scaled_.norm(step, free_);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(step.states.size());
    for (double part = 1; part > 1e-8; part *= 0.5) {
      State trial = state_;
      dynamics_.displace(trial.y, part * step.moved);
      const Layout& layout = dynamics_.model().layout();
      for (Eigen::Index k = 0; k < step.states.size(); ++k)
        trial.y[layout.positions + layout.speeds + static_cast<std::size_t>(k)] += part * step.states[k];
      const Change next =
          solve_for({dynamics_.residual(trial.time, trial.y, rest_), dynamics_.rates(trial.time, trial.y, rest_)});
      // At rounding a full step cannot improve any more; the test of convergence follows.
      if (scaled_.norm(next, free_) <= (1 - 0.25 * part) * size || (part == 1 && settled(step, 1e-9, 0, none))) {
        state_ = std::move(trial);
        return part;
      }
    }
    return 0;
  }
  /// Of the coordinates; not less than what no drawing shows.
  [[nodiscard]] double size() const {
    const Layout& layout = dynamics_.model().layout();
    double s = 1e-6;
    for (std::size_t i = 0; i < layout.positions; ++i) s = std::max(s, std::abs(state_.y[i]));
    return s;
  }

  const TangentDynamics& dynamics_;
  std::vector<Eigen::Index> free_;
  Eigen::Index n_;
  State state_;
  Eigen::VectorXd rest_, mass_;
  ScaledProblem scaled_;
  Eigen::MatrixXd matrix_;
  GradedMatrix solver_;
  bool singular_ = false;
};

/// No mode moves.
State at_rest(const Layout& layout, State state) {
  for (const Slot& slot : layout.bodies)
    for (std::size_t i = 0; i < slot.speeds; ++i) state.y[layout.positions + slot.speed + i] = 0;
  return state;
}

/// The greatest angle that a hinge has come by [rad], of coordinates that are one.
double turned(const Model& model, const State& from, const State& to) {
  double angle = 0;
  for (const ModelRate& rate : hinge_rates(model))
    if (rate.angular && rate.position) angle = std::max(angle, std::abs(to.y[*rate.position] - from.y[*rate.position]));
  return angle;
}

double greatest_angular_rate(const Model& model, const Eigen::VectorXd& speeds) {
  double rate = 0;
  for (const ModelRate& r : hinge_rates(model))
    if (r.angular) rate = std::max(rate, std::abs(speeds[static_cast<Eigen::Index>(r.speed)]));
  return rate;
}

}  // namespace

std::vector<Eigen::Index> free_speeds(const Held& held) {
  std::vector<Eigen::Index> indices;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (!held[i]) indices.push_back(static_cast<Eigen::Index>(i));
  }
  return indices;
}

Eigen::VectorXd accelerations(const TangentDynamics& dynamics, const State& state, const Held& held) {
  Eigen::VectorXd a = dynamics.steady_accelerations(state.time);
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (free.empty()) return a;
  const Eigen::MatrixXd M = dynamics.mass(state.time, state.y)(free, free);
  const Eigen::VectorXd residual = dynamics.residual(state.time, state.y, a);
  // No factors of what is not finite say anything of the masses.
  if (!M.allFinite() || !residual.allFinite()) throw std::domain_error("the derivatives at this state are not finite");
  // Masses of modes and inertias of small bodies may differ by many powers of ten.
  const Eigen::VectorXd scale = unit_inertias(M.diagonal().cwiseAbs());
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(scale.asDiagonal() * M * scale.asDiagonal());
  if (!lu.isInvertible()) throw std::domain_error("the mass matrix is singular at this state");
  a(free) = -scale.cwiseProduct(lu.solve(scale.cwiseProduct(residual(free))));
  return dynamics.whole(state.y, a);
}

SteadyState find_steady_state(const TangentDynamics& dynamics, const State& start, const Held& held) {
  const State resting = at_rest(dynamics.model().layout(), start);
  SteadyState found = Newton(dynamics, resting, held).solve();
  if (found.converged) {
    const double angle = turned(dynamics.model(), start, found.state);
    if (angle < near || (angle < std::numbers::pi && lasts(dynamics, found.state, held))) return found;
    found.strayed = angle;
  }
  const std::optional<Relaxation> relaxation = relaxed(dynamics, resting, held);
  if (!relaxation) return found;
  SteadyState settled = Newton(dynamics, relaxation->state, held).solve();
  if (!settled.converged) return found;
  settled.relaxations = relaxation->steps;
  return settled;
}

bool is_steady_state(const TangentDynamics& dynamics, const State& state, const Held& held) {
  return Newton(dynamics, state, held).solved();
}

bool stays_steady(const TangentDynamics& dynamics, const Tangents& tangents, const State& state, const Held& held) {
  const auto n = static_cast<Eigen::Index>(held.size());
  const auto free = free_speeds(held);
  if (free.empty()) return true;
  if (!slides_steadily(dynamics, state, held)) return false;
  const Eigen::Map<const Eigen::VectorXd> u(state.y.data() + dynamics.model().layout().positions, n);
  const Eigen::VectorXd change = tangents.by_position * u;
  const Eigen::VectorXd in_play =
      dynamics.terms_in_play(state.time, state.y, dynamics.steady_accelerations(state.time));
  const Eigen::VectorXd terms =
      tangents.by_position.cwiseAbs() * u.cwiseAbs() + greatest_angular_rate(dynamics.model(), u) * in_play;
  for (const Eigen::Index i : free)
    if (std::abs(change[i]) > 1e-9 * terms[i]) return false;
  // What loads measure must not change either.
  const Eigen::MatrixXd& measured = tangents.rate_by_position;
  if (measured.size() == 0) return true;
  const double rates =
      (measured.cwiseAbs() * u.cwiseAbs()).maxCoeff() + measured.cwiseAbs().maxCoeff() * u.cwiseAbs().maxCoeff();
  return (measured * u).cwiseAbs().maxCoeff() <= 1e-9 * rates;
}

}  // namespace withy
