#include "withy/core/analysis/turn.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/analysis/modes.hpp"
#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

/// Of a turn: eleven equal ones, at which no harmonic hides that is no multiple of eleven, and others for those.
std::vector<double> compared_shares() {
  std::vector<double> shares;
  for (int k = 0; k < 11; ++k) shares.push_back(k / 11.0);
  shares.insert(shares.end(), in_no_ratio.begin(), in_no_ratio.end());
  return shares;
}
/// A share of terms that cancel which counts as rounding.
constexpr double balanced_share = 1e-9;

/// Of a model at a state.
struct Balance {
  Eigen::VectorXd residual;  ///< of the free speeds
  Eigen::VectorXd terms;     ///< size of what cancels in it
  Eigen::VectorXd rates;     ///< of the continuous states of loads
  double measured = 0;       ///< size of what they are made of

  /// Whether what is left over here is another than there, beyond rounding.
  [[nodiscard]] bool differs(const Balance& there) const {
    const auto greatest = [](const Eigen::VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; };
    const Eigen::ArrayXd terms_of_both = terms.cwiseMax(there.terms).array();
    return ((residual - there.residual).array().abs() > balanced_share * terms_of_both).any() ||
           greatest(rates - there.rates) > balanced_share * std::max(measured, there.measured);
  }
};

Balance balance_of(const TangentDynamics& dynamics, const Tangents& t, const State& state,
                   const std::vector<Eigen::Index>& free) {
  const Layout& layout = dynamics.model().layout();
  const Eigen::VectorXd rest = dynamics.steady_accelerations(state.time);
  Balance b;
  b.residual = t.residual(free);
  b.terms = dynamics.terms_in_play(state.time, state.y, rest)(free);
  if (layout.continuous == 0) return b;
  b.rates = dynamics.rates(state.time, state.y, rest);
  b.measured = terms_of_rates(t, state, layout, b.rates);
  return b;
}

/// Whether mass, stiffness and what depends on speeds are the same here and there, each element against the diagonal:
/// beside vibrations that are a million times stiffer what weight does to a slow motion is nothing in A.
bool alike(const Tangents& here, const Tangents& there, const Balance& balance, double rate,
           const std::vector<Eigen::Index>& free) {
  constexpr double share = 1e-8;
  const auto m = static_cast<Eigen::Index>(free.size());
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < m; ++j) {
      const Eigen::Index a = free[static_cast<std::size_t>(i)], b = free[static_cast<std::size_t>(j)];
      const double mass = std::sqrt(std::abs(here.mass(a, a) * here.mass(b, b)));
      const double stiffness = std::sqrt((std::abs(here.by_position(a, a)) + balance.terms[i]) *
                                         (std::abs(here.by_position(b, b)) + balance.terms[j]));
      const auto changed = [&](const Eigen::MatrixXd& now, const Eigen::MatrixXd& first, double size) {
        return std::abs(now(a, b) - first(a, b)) > share * (std::abs(now(a, b)) + size);
      };
      if (changed(here.mass, there.mass, mass) || changed(here.by_position, there.by_position, stiffness) ||
          changed(here.by_speed, there.by_speed, mass * rate))
        return false;
    }
  }
  return true;
}

/// The state at one of `count` equal intervals of the period.
State at_instant(const Model& model, const State& start, const Turning& turning, Eigen::Index k, Eigen::Index count) {
  return carried(model, turning, start, turning.period * static_cast<double>(k) / static_cast<double>(count));
}

/// d/dt at `count` equal intervals of a period, of the trigonometric polynomial through the values there (count odd).
Eigen::MatrixXd differentiation(Eigen::Index count, double period) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto apart = static_cast<double>(i - j);
      if (i != j)
        D(i, j) = ((i - j) % 2 == 0 ? 1 : -1) / std::sin(std::numbers::pi * apart / static_cast<double>(count)) *
                  std::numbers::pi / period;
    }
  }
  return D;
}

/// Collocation at all instants at once: unknowns are the free coordinates there, instant after instant.
class Collocation {
 public:
  Collocation(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
              Eigen::Index count)
      : dynamics_(dynamics),
        layout_(dynamics.model().layout()),
        free_(free_speeds(held)),
        m_(static_cast<Eigen::Index>(free_.size())),
        count_(count),
        D_(differentiation(count, turning.period)),
        D2_(D_ * D_) {
    turn_.period = turning.period;
    turn_.constant = false;
    for (Eigen::Index k = 0; k < count; ++k) base_.push_back(at_instant(dynamics.model(), start, turning, k, count));
    locate_coordinates();
  }

  Turn solve() {
    Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(m_, count_);
    for (; turn_.iterations < 30; ++turn_.iterations) {
      linearize(moved);
      const Eigen::MatrixXd step = newton_step();
      if (!step.allFinite()) break;
      moved += step;
      const Eigen::VectorXd masses = turn_.points[0].mass.diagonal()(free_).cwiseAbs().cwiseSqrt();
      const double size = std::max((masses.asDiagonal() * (moved.colwise() + at_start())).cwiseAbs().maxCoeff(),
                                   least_displacement * masses.maxCoeff());
      if ((masses.asDiagonal() * step).cwiseAbs().maxCoeff() <= 1e-10 * size) {
        linearize(moved);
        return std::move(turn_);
      }
    }
    throw std::domain_error("no periodic motion was found: Newton's method did not converge");
  }

 private:
  /// The free coordinates must be those whose rates are the speeds.
  void locate_coordinates() {
    std::vector<Eigen::Index> position(layout_.speeds, -1);
    for (const ModelRate& rate : hinge_rates(dynamics_.model()))
      if (rate.position) position[rate.speed] = static_cast<Eigen::Index>(*rate.position);
    for (const Slot& slot : layout_.bodies) {
      for (std::size_t i = 0; i < slot.speeds; ++i)
        position[slot.speed + i] = static_cast<Eigen::Index>(slot.position + i);
    }
    for (const Eigen::Index s : free_) {
      const auto at = static_cast<std::size_t>(s);
      if (position[at] < 0)
        throw std::domain_error("no periodic motion is sought where the rotation of a free hinge is a quaternion ('" +
                                layout_.speed_names[at] + "'): lock it, or take a hinge with angles");
      if (base_[0].y[layout_.positions + at] != 0)
        throw std::domain_error("the free coordinates are not balanced over a turn, and '" + layout_.speed_names[at] +
                                "', which is free, turns: hold its rate (--spin)");
      positions_.push_back(position[at]);
    }
  }
  [[nodiscard]] Eigen::VectorXd at_start() const {
    Eigen::VectorXd x(m_);
    for (Eigen::Index i = 0; i < m_; ++i)
      x[i] = base_[0].y[static_cast<std::size_t>(positions_[static_cast<std::size_t>(i)])];
    return x;
  }
  void linearize(const Eigen::MatrixXd& moved) {
    const Eigen::MatrixXd rates = moved * D_.transpose(), accelerations = moved * D2_.transpose();
    turn_.states = base_;
    turn_.points.clear();
    for (Eigen::Index k = 0; k < count_; ++k) {
      State& state = turn_.states[static_cast<std::size_t>(k)];
      Eigen::VectorXd a = dynamics_.steady_accelerations(state.time);
      for (Eigen::Index i = 0; i < m_; ++i) {
        const auto at = static_cast<std::size_t>(i);
        state.y[static_cast<std::size_t>(positions_[at])] += moved(i, k);
        state.y[layout_.positions + static_cast<std::size_t>(free_[at])] += rates(i, k);
        a[free_[at]] = accelerations(i, k);
      }
      turn_.points.push_back(dynamics_.tangents(state.time, state.y, a));
    }
  }
  /// K δ + G Dδ + M D²δ = −r at every instant.
  [[nodiscard]] Eigen::MatrixXd newton_step() const {
    Eigen::MatrixXd J(m_ * count_, m_ * count_);
    Eigen::VectorXd right(m_ * count_);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const Tangents& t = turn_.points[static_cast<std::size_t>(k)];
      const Eigen::MatrixXd M = t.mass(free_, free_), G = t.by_speed(free_, free_);
      for (Eigen::Index l = 0; l < count_; ++l) J.block(m_ * k, m_ * l, m_, m_) = D2_(k, l) * M + D_(k, l) * G;
      J.block(m_ * k, m_ * k, m_, m_) += t.by_position(free_, free_);
      right.segment(m_ * k, m_) = -t.residual(free_);
    }
    const Eigen::VectorXd step = Eigen::PartialPivLU<Eigen::MatrixXd>(J).solve(right);
    return step.reshaped(m_, count_);
  }

  const TangentDynamics& dynamics_;
  const Layout& layout_;
  std::vector<Eigen::Index> free_;
  Eigen::Index m_, count_;
  Eigen::MatrixXd D_, D2_;
  std::vector<State> base_;
  std::vector<Eigen::Index> positions_;  ///< of the free speeds' coordinates
  Turn turn_;
};

/// A in coordinates scaled to unit inertia, rates by the scale that makes both halves alike; the continuous states of
/// loads as they are.
Eigen::MatrixXd scaled_form(const Tangents& t, const Held& held, const std::vector<Eigen::Index>& free) {
  Eigen::MatrixXd A = whole_first_order_form(t, held).A;
  const auto m = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(A.rows());
  scale.head(2 * m) << t.mass.diagonal()(free).cwiseAbs().cwiseSqrt(), t.mass.diagonal()(free).cwiseAbs().cwiseSqrt();
  A = scale.asDiagonal() * A * scale.cwiseInverse().asDiagonal();
  const double unit = unit_of_rates(A.block(m, 0, m, m), A.block(m, m, m, m));
  A.middleCols(m, m) *= unit;
  A.middleRows(m, m) /= unit;
  return A;
}

}  // namespace

double terms_of_rates(const Tangents& t, const State& state, const Layout& layout, const Eigen::VectorXd& rates) {
  const auto n = static_cast<Eigen::Index>(layout.speeds), k = static_cast<Eigen::Index>(layout.continuous);
  const Eigen::Map<const Eigen::VectorXd> u(state.y.data() + layout.positions, n), z(u.data() + n, k);
  return (t.rate_by_state.cwiseAbs() * z.cwiseAbs() + t.rate_by_speed.cwiseAbs() * u.cwiseAbs()).maxCoeff() +
         t.rate_by_position.cwiseAbs().maxCoeff() * least_displacement + rates.cwiseAbs().maxCoeff();
}

TurnCheck check_turn(const TangentDynamics& dynamics, const State& steady, const Held& held, double period) {
  TurnCheck check;
  check.turning = turning(dynamics.model(), steady, period);
  const std::vector<Eigen::Index> free = free_speeds(held);
  // Without a common period what is looked at is as much of the motion.
  const double over = one_turn(dynamics.model(), check.turning, steady);
  if (over == 0 || free.empty()) return check;
  Tangents at_start;
  Eigen::MatrixXd first;
  Eigen::VectorXd units;  // of states of loads beside the others; empty: there are none
  Balance start;
  double greatest = 0;
  for (const double share : compared_shares()) {
    const State state = carried(dynamics.model(), check.turning, steady, over * share);
    const Tangents t = dynamics.tangents(state.time, state.y, dynamics.steady_accelerations(state.time));
    const Balance b = balance_of(dynamics, t, state, free);
    Eigen::MatrixXd A = scaled_form(t, held, free);
    if (share == 0) {
      if (dynamics.model().layout().continuous > 0) units = balance_of_states(A);
      start = b;
      at_start = t;
    }
    if (units.size() > 0) A = (units.cwiseInverse().asDiagonal() * A * units.asDiagonal()).eval();
    if (share == 0) first = A;
    greatest = std::max(greatest, A.cwiseAbs().maxCoeff());
    check.change = std::max(check.change, (A - first).cwiseAbs().maxCoeff());
    if (b.differs(start)) check.steady = false;
    if (!alike(t, at_start, b, full_turn / over, free)) check.constant = false;
  }
  if (greatest > 0) check.change /= greatest;
  return check;
}

Turn find_turn(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
               Eigen::Index count) {
  Turn turn;
  turn.period = turning.period;
  const std::vector<Eigen::Index> free = free_speeds(held);
  for (Eigen::Index k = 0; k < count; ++k) {
    turn.states.push_back(at_instant(dynamics.model(), start, turning, k, count));
    const State& state = turn.states.back();
    turn.points.push_back(dynamics.tangents(state.time, state.y, dynamics.steady_accelerations(state.time)));
    if (free.empty()) continue;
    const Balance b = balance_of(dynamics, turn.points.back(), state, free);
    Balance nothing = b;
    nothing.residual.setZero(), nothing.rates.setZero();
    if (!b.differs(nothing)) continue;
    if (dynamics.model().layout().continuous > 0)
      throw std::domain_error(
          "the free coordinates are not balanced over a turn, and no periodic motion is sought where loads have "
          "differential equations of their own");
    return Collocation(dynamics, start, held, turning, count).solve();
  }
  return turn;
}

}  // namespace withy
