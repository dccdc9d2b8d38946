#include "withy/study/level_integration.hpp"

#include <algorithm>
#include <cmath>
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
      return LevelIntegration{loose->point.integrator, loose->point.tolerance, tight->own,
                              static_cast<double>(loose->walk.evaluations)};
    loose = std::move(tight);
  }
  return {};
}

const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations) {
  const auto evaluations = [&](const LevelIntegration& i) {
    return i.integrator == "dop853" ? std::max(i.evaluations, explicit_evaluations) : i.evaluations;
  };
  return *std::min_element(integrations.begin(), integrations.end(),
                           [&](const auto& a, const auto& b) { return evaluations(a) < evaluations(b); });
}

}  // namespace withy::study
