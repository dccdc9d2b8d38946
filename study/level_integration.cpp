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

namespace {

constexpr const char* explicit_steps = "dop853";
/// Times what its stability asks at least: what it takes there, with the steps that it tries again, and up to where
/// stability counts as what limits its steps.
constexpr double at_stability = 1.5, most_at_stability = 2;

}  // namespace

bool limited_by_stability(const std::string& integrator, double evaluations, double explicit_evaluations) {
  return integrator == explicit_steps && evaluations < most_at_stability * explicit_evaluations;
}

void LevelGrowth::note(int modes, const LevelIntegration& with, double evaluations, double explicit_evaluations) {
  const Seen seen{std::max(1.0, evaluations / with.evaluations),
                  limited_by_stability(with.integrator, evaluations, explicit_evaluations)};
  const auto [known, is_new] = seen_.emplace(modes, seen);
  if (!is_new && known->second.at_most) known->second = seen;
}

double LevelGrowth::expected(int modes) const {
  double least = 1, most = 1;
  for (auto seen = seen_.begin(); seen != seen_.upper_bound(modes); ++seen) {
    most = seen->second.at_most ? std::max(least, seen->second.times) : seen->second.times;
    if (!seen->second.at_most) least = most;
  }
  return std::sqrt(least * most);
}

const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations,
                                      double growth) {
  const bool all_tell =
      std::none_of(integrations.begin(), integrations.end(), [](const auto& i) { return i.at_stability; });
  const double known = all_tell ? growth : 1;
  const auto evaluations = [&](const LevelIntegration& i) {
    const double accurate = known * i.evaluations;
    return i.integrator == explicit_steps ? std::max(accurate, at_stability * explicit_evaluations) : accurate;
  };
  return *std::min_element(integrations.begin(), integrations.end(),
                           [&](const auto& a, const auto& b) { return evaluations(a) < evaluations(b); });
}

}  // namespace withy::study
