#include "withy/study/level_integrations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace withy::study {
namespace {

/// The loosest tolerance that is looked at, where that of the coarsest level that is asked for is not looser: the
/// loosest of candidates. Steps that fast modes limit, or that fold these in, add next to nothing to slow outputs.
constexpr double loosest_tolerance = 1e-2;
/// Times what the coarsest level costs with the integrations known so far: what it may cost with another, which may be
/// the better one with more modes.
constexpr double worth_measuring = 4;
/// Of the time that is left: what that may cost in any case. Where explicit steps cost little with two modes, one that
/// costs ten times as much may be the better one with ten.
constexpr double look_share = 0.01;
/// Of the time that is left: what it may cost at most, but for what takes hardly longer than the best. Where the
/// coarsest level takes a fiftieth of the time, ways that cost several times as much take what levels need.
constexpr double most_look_share = 0.02, hardly_longer = 1.5;
/// Times the modes of the level at which it was measured what integration adds: with more it is measured again.
constexpr int many_more = 2;
/// Of the time that is left: what a run may cost that tells it.
constexpr double confirming_share = 0.15;

}  // namespace

/// In the lowest rung that truncates nothing.
Point LevelIntegrations::coarsest() const {
  Point point = goal_.first;
  point.formulation = reference_formulations(registry_).back();
  return point;
}

/// What a run that measures an integration may cost where another took that [s].
double LevelIntegrations::worth(double least) const {
  if (!goal_.left) return worth_measuring * least;
  const double left = goal_.left(), worth = std::max(worth_measuring * least, look_share * left);
  return std::max(hardly_longer * least, std::min(worth, most_look_share * left));
}

/// Explicit steps, such that fold in what is stiff in bodies, and such that care for nothing that is stiff, as a damper
/// on a hinge between light bodies is.
std::vector<std::string> LevelIntegrations::integrators(const Prepared& prepared) const {
  std::vector<std::string> ids{goal_.first.integrator};
  if (prepared.equations->linearly_implicit() != nullptr) ids.emplace_back("imex");
  if (registry_.find<Integrator>("radau") != nullptr) ids.emplace_back("radau");
  return ids;
}

void LevelIntegrations::measure(const Run& run, const std::function<bool()>& stopped) {
  const ModelAt& model = model_at_(coarsest());
  if (model.refused()) return;
  least_ = least_of_next_ = std::numeric_limits<double>::infinity();
  for (const std::string& integrator : integrators(*model.prepared)) {
    if (stopped()) return;
    measure(integrator, run);
  }
}

void LevelIntegrations::measure(const std::string& integrator, const Run& run) {
  Point look = coarsest();
  look.integrator = integrator;
  const double seconds = worth(least_);
  const auto run_with = [&](double tolerance) {
    look.tolerance = tolerance;
    return run(look, seconds);
  };
  const auto little = [&](const Reference& r) { return goal_.integration(r) <= 1; };
  const double loosest = std::max({loosest_tolerance, goal_.first.tolerance, goal_.tightest});
  auto measured = loosest_integration({outputs_, run_with, little, loosest, goal_.tightest});
  if (!measured) return;
  all_.push_back(std::move(*measured));
  if (const auto chosen = run_with(all_.back().tolerance)) least_ = std::min(least_, chosen->walk.seconds);
  // How it goes on with modes.
  ++look.modes;
  if (const auto next = run(look, worth(least_of_next_))) least_of_next_ = std::min(least_of_next_, next->walk.seconds);
}

Point LevelIntegrations::on(Point point) const {
  if (all_.empty()) return point;
  Point plain = point;
  plain.formulation = reference_formulations(registry_).back();
  const ModelAt& model = model_at_(plain);
  const LevelIntegration& with = cheapest_with(all_, model.refused() ? 0 : explicit_evaluations(model), point.modes);
  point.integrator = with.integrator, point.tolerance = with.tolerance;
  return point;
}

LevelIntegration* LevelIntegrations::of(const Point& point) {
  const auto with = std::find_if(all_.begin(), all_.end(), [&](const LevelIntegration& i) {
    return i.integrator == point.integrator && i.tolerance == point.tolerance;
  });
  return with == all_.end() ? nullptr : &*with;
}

std::optional<Reference> LevelIntegrations::confirm(Reference& level, const Run& run,
                                                    const std::function<bool(const Reference&)>& enough) {
  LevelIntegration* const with = of(level.point);
  if (with == nullptr || level.point.modes <= many_more * with->measured_at) return {};
  Point point = level.point;
  point.formulation = reference_formulations(registry_).back();
  const double seconds = goal_.left ? confirming_share * goal_.left() : std::numeric_limits<double>::infinity();
  const std::optional<Reference> loose = run(point, seconds);
  point.tolerance = std::max(std::pow(10, std::round(std::log10(point.tolerance)) - 1), goal_.tightest);
  if (!loose || point.tolerance == level.point.tolerance) return {};
  std::optional<Reference> tight = run(point, seconds);
  if (!tight) return {};
  const Distances added = distances(outputs_, tight->readings, loose->readings).first;
  for (std::size_t k = 0; k < added.size(); ++k) level.own[k] += std::max(0.0, added[k] - with->added[k]);
  if (enough(level)) return {};
  with->tolerance = point.tolerance;
  with->evaluations = {{point.modes, static_cast<double>(tight->walk.evaluations)}};
  return tight;
}

void LevelIntegrations::note(const Reference& run) {
  if (LevelIntegration* const with = of(run.point))
    with->evaluations[run.point.modes] = static_cast<double>(run.walk.evaluations);
}

double LevelIntegrations::expected_seconds(const Point& point) const {
  for (const LevelIntegration& with : all_)
    if (with.integrator == point.integrator && with.tolerance == point.tolerance)
      return model_at_(point).seconds * with.expected(point.modes);
  return std::numeric_limits<double>::infinity();
}

void LevelIntegrations::add_to(Reference& level) const {
  for (const LevelIntegration& with : all_)
    if (with.integrator == level.point.integrator)
      for (std::size_t k = 0; k < level.own.size(); ++k) level.own[k] += with.added[k];
}

}  // namespace withy::study
