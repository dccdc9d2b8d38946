#include "withy/core/analysis/between_instants.hpp"

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

/// The trigonometric polynomial that is 1 at one of `count` equal intervals and 0 at the others, `apart` periods from
/// there on.
double cardinal(Eigen::Index count, double apart) {
  const double half = std::numbers::pi * apart, below = std::sin(half);
  const auto all = static_cast<double>(count);
  return below == 0 ? 1 : std::sin(all * half) / (all * below);
}

/// Its derivative with respect to the share of the period.
double cardinal_slope(Eigen::Index count, double apart) {
  double slope = 0;
  for (Eigen::Index n = 1; 2 * n < count; ++n) {
    const double rate = full_turn * static_cast<double>(n);
    slope -= 2 * rate * std::sin(rate * apart);
  }
  return slope / static_cast<double>(count);
}

/// The state at that time, and to `accelerations` what the free coordinates have.
State course_at(const TangentDynamics& dynamics, const State& start, const Turning& turning, const Turn& turn,
                double share, Eigen::VectorXd& accelerations) {
  State state = carried(dynamics.model(), turning, start, share * turning.period);
  accelerations = dynamics.steady_accelerations(state.time);
  if (turn.constant) return state;
  const auto count = static_cast<Eigen::Index>(turn.states.size());
  const std::size_t positions = dynamics.model().layout().positions;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double at = static_cast<double>(k) / static_cast<double>(count);
    const State& there = turn.states[static_cast<std::size_t>(k)];
    const State carried_there = carried(dynamics.model(), turning, start, at * turning.period);
    const double value = cardinal(count, share - at), slope = cardinal_slope(count, share - at) / turning.period;
    for (std::size_t i = 0; i < there.y.size(); ++i) {
      const double moved = there.y[i] - carried_there.y[i];
      state.y[i] += value * moved;
      if (i >= positions && i < positions + static_cast<std::size_t>(accelerations.size()))
        accelerations[static_cast<Eigen::Index>(i - positions)] += slope * moved;
    }
  }
  return state;
}

/// Of the continuous states of loads: their rates, of what these are made of.
double rates_left(const TangentDynamics& dynamics, const State& state, const Eigen::VectorXd& accelerations,
                  const Tangents& t) {
  const Layout& layout = dynamics.model().layout();
  if (layout.continuous == 0) return 0;
  const Eigen::VectorXd rates = dynamics.rates(state.time, state.y, accelerations);
  const double rate = rates.cwiseAbs().maxCoeff();
  return rate > 0 ? rate / terms_of_rates(t, state, layout, rates) : 0;
}

/// Places in each interval between instants: the highest harmonic goes through π/16 from one to the next, and what a
/// parabola through three of them misses of its peak is below 0.024 (π/16)⁴ < 4e-5.
constexpr std::size_t places_apart = 16;

/// Of a function at equal intervals of its period: the peak of the parabola through the greatest and those beside it.
double greatest_of(const std::vector<double>& values) {
  const std::size_t count = values.size();
  std::size_t at = 0;
  for (std::size_t p = 1; p < count; ++p)
    if (std::abs(values[p]) > std::abs(values[at])) at = p;
  const double peak = std::abs(values[at]), sign = std::copysign(1.0, values[at]),
               before = sign * values[(at + count - 1) % count], after = sign * values[(at + 1) % count];
  const double bend = before - 2 * peak + after;
  return bend < 0 ? peak - (after - before) * (after - before) / (8 * bend) : peak;
}

}  // namespace

Between between_instants(const TangentDynamics& dynamics, const State& start, const Held& held, const Turning& turning,
                         const Turn& turn, double share, const Eigen::VectorXd& frequencies) {
  Eigen::VectorXd accelerations;
  const State state = course_at(dynamics, start, turning, turn, share, accelerations);
  Between here;
  here.tangents = dynamics.tangents(state.time, state.y, accelerations);
  here.left = rates_left(dynamics, state, accelerations, here.tangents);
  const std::vector<Eigen::Index> free = free_speeds(held);
  const Eigen::VectorXd terms = dynamics.terms_in_play(state.time, state.y, accelerations);
  for (std::size_t i = 0; i < free.size(); ++i) {
    const Eigen::Index s = free[i];
    const double frequency = frequencies[static_cast<Eigen::Index>(i)], left = std::abs(here.tangents.residual[s]),
                 size = terms[s] + std::abs(here.tangents.mass(s, s)) * frequency * frequency * least_displacement;
    if (left > 0) here.left = std::max(here.left, left / size);
  }
  return here;
}

std::vector<double> greatest_excursions(const Turn& turn) {
  const std::size_t count = turn.states.size(), positions = turn.states[0].y.size(), places = places_apart * count;
  std::vector<double> weights(places), away(places), greatest(positions, 0.0);
  if (turn.constant) return greatest;
  for (std::size_t p = 0; p < places; ++p)
    weights[p] = cardinal(static_cast<Eigen::Index>(count), static_cast<double>(p) / static_cast<double>(places));
  for (std::size_t i = 0; i < positions; ++i) {
    for (std::size_t p = 0; p < places; ++p) {
      away[p] = 0;
      for (std::size_t k = 0; k < count; ++k)
        away[p] += weights[(p + places - places_apart * k) % places] * (turn.states[k].y[i] - turn.states[0].y[i]);
    }
    greatest[i] = greatest_of(away);
  }
  return greatest;
}

}  // namespace withy
