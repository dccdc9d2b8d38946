#include "withy/campaign/overlaps.hpp"

#include <fmt/format.h>

#include "withy/campaign/derived.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/value_path.hpp"

namespace withy::campaign {
namespace {

/// Whether a value says itself what stands at a path in it. The short form of a choice is its name.
bool gives(const Value& value, const std::string& path) {
  return value_at(value, path) != nullptr || (value.kind() == Value::Kind::text && path == "name");
}

bool any_gives(const Levels& levels, const std::string& path) {
  for (const Value& value : levels.values)
    if (gives(value, path)) return true;
  return false;
}

/// Why the later of two paths may not be set behind the earlier; empty where it may.
/// \param levels of the earlier; null where it is derived
std::string overlap_problem(const std::string& earlier, const Levels* levels, const std::string& later) {
  if (is_within(earlier, later))
    return fmt::format("takes the place of {}, which varies before it: leave one of them out, or give the whole first",
                       in_quotes(earlier));
  if (levels != nullptr && is_within(later, earlier) && any_gives(*levels, later.substr(earlier.size() + 1)))
    return fmt::format("takes the place of a part that values of {} give: leave it out there, or here",
                       in_quotes(earlier));
  return {};
}

}  // namespace

bool is_within(const std::string& path, const std::string& whole) {
  return path.size() > whole.size() && path[whole.size()] == '.' && path.starts_with(whole);
}

void check_overlaps(const Plan& plan, const PlanReader& reader) {
  const auto report = [&](const Place& place, const std::string& problem) {
    if (!problem.empty()) reader.error(place, problem);
  };
  const std::size_t axes = plan.axes.size();
  // One at a time, no case has two of what varies.
  for (std::size_t b = 0; b < axes && plan.design != Design::one_at_a_time; ++b)
    for (std::size_t a = 0; a < b; ++a)
      report(plan.axes[b].place, overlap_problem(plan.axes[a].path, &plan.axes[a].levels, plan.axes[b].path));
  for (std::size_t d = 0; d < plan.derived.size(); ++d) {
    const Derived& derived = plan.derived[d];
    for (const Axis& axis : plan.axes) report(derived.place, overlap_problem(axis.path, &axis.levels, derived.path));
    for (std::size_t before = 0; before < d; ++before)
      report(derived.place, overlap_problem(plan.derived[before].path, nullptr, derived.path));
  }
}

}  // namespace withy::campaign
