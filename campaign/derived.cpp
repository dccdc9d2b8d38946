#include "withy/campaign/derived.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "withy/campaign/overlaps.hpp"
#include "withy/campaign/trials.hpp"
#include "withy/core/plugin/formula.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/value_path.hpp"

namespace withy::campaign {
namespace {

/// The scene's own number at a path, in SI units; nothing where there is none.
std::optional<double> own_number(const study::Prepared& base, const std::string& path) {
  return number_at(base.scene.source, path);
}

/// Why a name that is no path of what varies cannot be used; empty where it can. Its own path stands for the scene's
/// number there: a formula may scale it.
std::string scene_name_trouble(const Plan& plan, const Derived& derived, const std::string& name) {
  for (const std::string& path : varied_paths(plan)) {
    if (path != derived.path && path == name)
      return fmt::format("{} is derived behind it: give that before", in_quotes(name));
    if (is_within(name, path))
      return fmt::format("{} is a part of {}, so that cases have other numbers there: vary or derive it by itself",
                         in_quotes(name), in_quotes(path));
  }
  if (own_number(*plan.base, name)) return {};
  return fmt::format("{} neither varies nor is a number of the scene", in_quotes(name));
}

/// Why a name cannot be used; empty where it can.
/// \param place among varied_paths(); −1: none of them
/// \param read whether levels with units have been read as numbers: they are where nothing else is wrong
std::string name_trouble(const Plan& plan, const Derived& derived, const std::string& name, int place, bool read) {
  if (place < 0) return scene_name_trouble(plan, derived, name);
  const auto index = static_cast<std::size_t>(place);
  if (index >= plan.axes.size()) return {};
  if (plan.design == Design::one_at_a_time && !own_number(*plan.base, name))
    return in_quotes(name) + " is not a number of the scene";
  const Axis& varied = plan.axes[index];
  if (varied.drawn() || !varied.levels.numbers.empty() || !read) return {};
  return fmt::format("{} varies, but not as plain numbers", in_quotes(name));
}

}  // namespace

std::optional<double> number_at(const Value& source, const std::string& path) {
  const Value* at = value_at(source, path);
  if (at == nullptr || at->kind() != Value::Kind::number) return {};
  return at->number();
}

std::vector<std::string> varied_paths(const Plan& plan) {
  std::vector<std::string> paths;
  for (const Axis& axis : plan.axes) paths.push_back(axis.path);
  for (const Derived& d : plan.derived) paths.push_back(d.path);
  return paths;
}

void read_derived(const Value& given, const PlanReader& reader, Plan& plan) {
  if (given.kind() != Value::Kind::map)
    return reader.error(given.place(), fmt::format("got {}; need a map of paths to formulas", shown(given)));
  for (const auto& [path, value] : given.members()) {
    const std::vector<std::string> varied = varied_paths(plan);
    const auto formula = reader.text(value);
    if (!formula) continue;
    if (std::find(varied.begin(), varied.end(), path) != varied.end())
      reader.error(value.place(), in_quotes(path) + " varies already");
    try {
      Derived d{path, *formula, value.place(), {}};
      const Formula parsed(*formula);
      for (const std::string& name : parsed.names()) {
        const auto at = std::find(varied.begin(), varied.end(), name);
        d.names.emplace_back(name, at == varied.end() ? -1 : static_cast<int>(at - varied.begin()));
      }
      plan.derived.push_back(std::move(d));
    } catch (const std::invalid_argument& e) {
      reader.error(value.place(), e.what());
    }
  }
}

void check_derived(const Plan& plan, Problems& problems) {
  const bool read = problems.none();
  for (const Derived& d : plan.derived)
    for (const auto& [name, at] : d.names)
      if (const std::string why = name_trouble(plan, d, name, at, read); !why.empty())
        problems.of_plan().error(d.place, why);
}

std::optional<double> value_of(const Derived& derived, const Value& source, const CaseValues& values) {
  std::vector<double> named;
  for (const auto& [name, at] : derived.names) {
    const std::optional<Value> varied = at < 0 ? std::nullopt : values[static_cast<std::size_t>(at)];
    if (varied && varied->kind() != Value::Kind::number) return {};
    const std::optional<double> number = varied ? varied->number() : number_at(source, name);
    if (!number) return {};
    named.push_back(*number);
  }
  return Formula(derived.formula)(named);
}

}  // namespace withy::campaign
