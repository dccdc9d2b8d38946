#include "withy/core/analysis/sliding.hpp"

#include <algorithm>
#include <cmath>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

/// Calls `meet(element of the coordinates in y, rate, whether it turns)` for every coordinate whose derivative is a
/// speed.
template <class Meet>
void for_each_rate(const Model& model, const State& state, Meet&& meet) {
  const Layout& layout = model.layout();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    std::size_t s = layout.positions + layout.hinges[h].speed;
    for (const HingeRate& rate : hinge_rates(*model.hinges()[h].hinge)) {
      if (rate.coordinate) meet(layout.hinges[h].position + *rate.coordinate, state.y[s], rate.angular);
      ++s;
    }
  }
}

double fastest_slide(const Model& model, const State& state) {
  double fastest = 0;
  for_each_rate(model, state, [&](std::size_t, double rate, bool angular) {
    if (!angular) fastest = std::max(fastest, std::abs(rate));
  });
  return fastest;
}

}  // namespace

bool slides(const TangentDynamics& dynamics, const State& state) { return fastest_slide(dynamics.model(), state) > 0; }

bool slides_steadily(const TangentDynamics& dynamics, const State& state, const Held& held) {
  /// [m] on the way. Any will do that are not nothing beside the scene and in no ratio of small whole numbers.
  constexpr double ways[] = {-0.37, 0.61};
  /// Of the terms in it, as what is balanced is known.
  constexpr double share = 1e-9;
  const double fastest = fastest_slide(dynamics.model(), state);
  const std::vector<Eigen::Index> free = free_speeds(held);
  if (fastest == 0 || free.empty()) return true;
  const Eigen::VectorXd rest = dynamics.steady_accelerations(state.time);
  const Eigen::VectorXd here = dynamics.residual(state.time, state.y, rest);
  for (const double way : ways) {
    State there = state;
    for_each_rate(dynamics.model(), state,
                  [&](std::size_t at, double rate, bool) { there.y[at] += rate * (way / fastest); });
    const Eigen::VectorXd changed = dynamics.residual(there.time, there.y, rest) - here;
    const Eigen::VectorXd terms = dynamics.terms_in_play(there.time, there.y, rest);
    for (const Eigen::Index i : free)
      if (!(std::abs(changed[i]) <= share * terms[i])) return false;
  }
  return true;
}

}  // namespace withy
