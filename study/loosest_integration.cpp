#include "withy/study/loosest_integration.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace withy::study {

std::optional<LevelIntegration> loosest_integration(const IntegrationSearch& search) {
  constexpr double rounding = 1e-9;
  // Powers of ten, which candidates have too: a level may be one.
  const auto digits = [](double tolerance) { return static_cast<int>(std::floor(std::log10(tolerance) + rounding)); };
  const auto run = [&](int digit) { return search.run(std::pow(10, digit)); };
  int digit = digits(search.loosest);
  std::optional<Reference> loose = run(digit);
  while (loose && digit > digits(search.tightest)) {
    std::optional<Reference> tight = run(--digit);
    if (!tight) break;
    tight->own = distances(search.outputs, tight->readings, loose->readings).first;
    if (search.little(*tight))
      return LevelIntegration{loose->point.integrator,
                              loose->point.tolerance,
                              tight->own,
                              {{loose->point.modes, static_cast<double>(loose->walk.evaluations)}},
                              loose->point.modes};
    loose = std::move(tight);
  }
  return {};
}

double LevelIntegration::expected(int modes) const {
  const auto beyond = evaluations.upper_bound(modes);
  if (beyond == evaluations.begin()) return beyond == evaluations.end() ? 0 : beyond->second;
  const auto [last_modes, last] = *std::prev(beyond);
  if (std::prev(beyond) == evaluations.begin()) return last;
  const auto [modes_before, before] = *std::prev(beyond, 2);
  const double power =
      std::max(0.0, std::log(last / before) / std::log(static_cast<double>(last_modes) / modes_before));
  return last * std::pow(static_cast<double>(modes) / last_modes, power);
}

const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations,
                                      int modes) {
  constexpr const char* explicit_steps = "dop853";
  constexpr const char* solves = "radau";
  /// Times what stability asks at least: with the steps that it tries again.
  constexpr double at_stability = 1.5;
  constexpr double of_solving = 2;
  const auto cost = [&](const LevelIntegration& i) {
    const double evaluations = i.expected(modes);
    if (i.integrator == explicit_steps) return std::max(evaluations, at_stability * explicit_evaluations);
    return i.integrator == solves ? of_solving * evaluations : evaluations;
  };
  return *std::min_element(integrations.begin(), integrations.end(),
                           [&](const auto& a, const auto& b) { return cost(a) < cost(b); });
}

}  // namespace withy::study
