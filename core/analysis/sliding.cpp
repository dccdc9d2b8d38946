#include "withy/core/analysis/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {
namespace {

double rate_at(const Model& model, const State& state, const ModelRate& rate) {
  return state.y[model.layout().positions + rate.speed];
}

double fastest_slide(const Model& model, const State& state) {
  double fastest = 0;
  for (const ModelRate& rate : hinge_rates(model))
    if (rate.position && !rate.angular) fastest = std::max(fastest, std::abs(rate_at(model, state, rate)));
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
  const std::vector<ModelRate> rates = hinge_rates(dynamics.model());
  const Eigen::VectorXd rest = dynamics.steady_accelerations(state.time);
  const Eigen::VectorXd here = dynamics.residual(state.time, state.y, rest);
  for (const double way : ways) {
    State there = state;
    for (const ModelRate& rate : rates)
      if (rate.position) there.y[*rate.position] += rate_at(dynamics.model(), state, rate) * (way / fastest);
    const Eigen::VectorXd changed = dynamics.residual(there.time, there.y, rest) - here;
    const Eigen::VectorXd terms = dynamics.terms_in_play(there.time, there.y, rest);
    for (const Eigen::Index i : free)
      if (!(std::abs(changed[i]) <= share * terms[i])) return false;
  }
  return true;
}

}  // namespace withy
