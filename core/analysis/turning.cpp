#include "withy/core/analysis/turning.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

/// The rate of a motion that is constant for as long as can be seen; nothing where it is not.
std::optional<double> constant_rate(const Motion& motion, double t) {
  const double rate = motion.at(t).rate;
  const double span = std::max(1.0, rate != 0 ? full_turn / std::abs(rate) : 0.0);
  for (int k = 0; k <= 64; ++k) {
    const MotionPoint point = motion.at(t + span * k / 64);
    if (std::abs(point.rate - rate) > 1e-12 * std::abs(rate) || std::abs(point.acceleration) > 1e-12 * std::abs(rate))
      return {};
  }
  return rate;
}

/// The least whole number n ≤ 24 with n·ratio whole too; 0 where there is none.
int common_multiple(double ratio) {
  for (int n = 1; n <= 24; ++n) {
    if (std::abs(n * ratio - std::round(n * ratio)) <= 1e-9 * std::max(1.0, n * ratio)) return n;
  }
  return 0;
}

/// Adds a rate to the common period of those before.
void add_rate(Turning& turning, double rate, bool angular, const std::string& name) {
  if (rate == 0 || !turning.problem.empty()) return;
  if (!angular) {
    turning.problem = "'" + name + "' moves along a line and does not come back";
    return;
  }
  const double own = full_turn / std::abs(rate);
  if (turning.period == 0) {
    turning.period = own;
  } else if (const int n = common_multiple(turning.period / own); n > 0) {
    turning.period *= n;
  } else {
    turning.problem = "the hinges turn at rates without a common period ('" + name + "')";
  }
}

/// Carries the quaternion of a hinge, q̇ = N(q) ω, on with a constant angular velocity: |ω| t/2 along its great circle.
void turn_quaternion(const Hinge& hinge, const std::vector<HingeRate>& rates, const std::vector<double>& angular,
                     double after, std::span<double> x) {
  double squares = 0;
  for (const double rate : angular) squares += rate * rate;
  if (squares == 0) return;
  const double speed = std::sqrt(squares), half = 0.5 * speed * after;
  std::vector<double> along(x.size());
  hinge.derivatives(x, angular, along);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool apart =
        std::any_of(rates.begin(), rates.end(), [&](const HingeRate& rate) { return rate.coordinate == i; });
    if (!apart) x[i] = std::cos(half) * x[i] + 2 * std::sin(half) / speed * along[i];
  }
}

}  // namespace

Turning turning(const Model& model, const State& state, double period) {
  Turning result;
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    if (model.driven(h)) continue;
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
    double squares = 0;  // of an angular velocity, about whose axis it turns
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const double rate = state.y[layout.positions + slot.speed + i];
      if (rate == 0) continue;
      result.speeds.push_back(slot.speed + i);
      if (rates[i].coordinate)
        add_rate(result, rate, rates[i].angular, slot.name);
      else
        squares += rate * rate;
    }
    add_rate(result, std::sqrt(squares), true, slot.name);
  }
  for (const MotionNode& node : model.motions()) {
    if (node.motion->locks() || period > 0) continue;
    const auto h = static_cast<std::size_t>(node.hinge);
    if (const std::optional<double> rate = constant_rate(*node.motion, state.time)) {
      add_rate(result, *rate, hinge_rates(*model.hinges()[h].hinge)[0].angular, layout.hinges[h].name);
    } else if (result.problem.empty()) {
      result.problem = "motion '" + node.name + "' does not turn at a constant rate: give the period";
    }
  }
  if (period > 0) {
    if (result.period > 0 && std::abs(std::remainder(period, result.period)) > 1e-9 * period)
      result.problem = "the hinges do not come back after the period given";
    result.period = period;
  }
  if (!result.problem.empty()) result.period = 0;
  return result;
}

State carried(const Model& model, const Turning& turning, const State& start, double after) {
  State state = start;
  state.time += after;
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
    std::vector<double> angular(slot.speeds, 0.0);
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const std::size_t s = slot.speed + i;
      if (std::find(turning.speeds.begin(), turning.speeds.end(), s) == turning.speeds.end()) continue;
      if (const auto x = rates[i].coordinate)
        state.y[slot.position + *x] += after * start.y[layout.positions + s];
      else
        angular[i] = start.y[layout.positions + s];
    }
    turn_quaternion(*model.hinges()[h].hinge, rates, angular, after,
                    std::span(state.y).subspan(slot.position, slot.positions));
  }
  model.prescribe(state);
  return state;
}

double one_turn(const Model& model, const Turning& turning, const State& state) {
  if (turning.period > 0) return turning.period;
  double longest = 0;
  for (const std::size_t s : turning.speeds)
    longest = std::max(longest, full_turn / std::abs(state.y[model.layout().positions + s]));
  return longest;
}

std::vector<std::size_t> uneven_motions(const TangentDynamics& dynamics, const State& state, const Held& held) {
  const Model& model = dynamics.model();
  std::vector<std::size_t> uneven;
  for (std::size_t m = 0; m < model.motions().size(); ++m)
    if (const Motion& motion = *model.motions()[m].motion; !motion.locks() && !constant_rate(motion, state.time))
      uneven.push_back(m);
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (uneven.empty() || free.empty()) return {};
  const Tangents t = dynamics.tangents(state.time, state.y, dynamics.steady_accelerations(state.time));
  std::erase_if(uneven, [&](std::size_t m) {
    const auto hinge = static_cast<std::size_t>(model.motions()[m].hinge);
    const auto driven = static_cast<Eigen::Index>(model.layout().hinges[hinge].speed);
    const auto unmoved = [&](const Eigen::MatrixXd& by) { return by(free, driven).isZero(0); };
    return unmoved(t.mass) && unmoved(t.by_position) && unmoved(t.by_speed) &&
           (t.rate_by_position.size() == 0 ||
            (t.rate_by_position.col(driven).isZero(0) && t.rate_by_speed.col(driven).isZero(0)));
  });
  return uneven;
}

}  // namespace withy
