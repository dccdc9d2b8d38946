#include "withy/campaign/si_levels.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "withy/campaign/derived.hpp"
#include "withy/campaign/trials.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/units.hpp"

namespace withy::campaign {
namespace {

std::optional<AnyQuantity> quantity_of(const Value& value) {
  if (value.kind() != Value::Kind::text) return {};
  const AnyQuantity read = read_any_quantity(value.text());
  return read.value ? std::optional(read) : std::nullopt;
}

/// The scene with a level of an axis, and those of the same row where these are columns of a list: rows are cases, and
/// what stands in two of them may not go together. Of other axes what it took a value of this one with.
SceneValues with_level(const Plan& plan, SceneValues scene, const Tried& tried, std::size_t axis, std::size_t level) {
  CaseValues values = tried.beside[axis];
  values.resize(plan.axes.size());
  values[axis] = plan.axes[axis].levels.at(level);
  for (std::size_t b = 0; b < values.size() && plan.design == Design::product; ++b)
    if (const Axis& other = plan.axes[b]; !other.drawn() && other.grid == plan.axes[axis].grid)
      values[b] = other.levels.at(level);
  set_values(plan, tried.source, std::move(values), true, scene);
  return scene;
}

/// Whether the scene can be made with a number at a path: one where names are meant cannot.
bool takes(SceneValues values, const std::string& path, double number, Registry& registry) try {
  values.set(path, Value(number), path);
  static_cast<void>(make_scene(values, registry));
  return true;
} catch (const SceneError&) {
  return false;
}

/// Whether a scene with a quantity at a path has a number there; nothing where there is no such scene: its cases say
/// what is wrong with them.
std::optional<bool> is_number(const SceneValues& values, const std::string& path, double number,
                              Registry& registry) try {
  // Numbers whose unit is known with a hinge, as those it starts with, stand in the checked scene as they were written.
  const std::optional<double> checked = number_at(make_scene(values, registry).source, path);
  return checked == number || (!checked && takes(values, path, number, registry));
} catch (const SceneError&) {
  return {};
}

/// Those of this kind as numbers.
void convert(Levels& levels, const Dimension& dimension) {
  for (Value& value : levels.values)
    if (const auto read = quantity_of(value); read && read->dimension == dimension) value = Value(*read->value);
  const auto plain = [](const Value& v) { return v.kind() == Value::Kind::number; };
  if (!std::all_of(levels.values.begin(), levels.values.end(), plain)) return;
  for (const Value& value : levels.values) levels.numbers.push_back(value.number());
  levels.values.clear();
}

}  // namespace

void use_si(Plan& plan, const SceneValues& base, const Tried& tried, Registry& registry) {
  constexpr int wrong_rows = 16;  // each costs a scene, and a list may have a million
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    Axis& axis = plan.axes[a];
    int tries = 0;
    for (std::size_t k = 0; k < axis.levels.size() && tries < wrong_rows; ++k) {
      const std::optional<AnyQuantity> read = quantity_of(axis.levels.at(k));
      if (!read) continue;
      ++tries;
      const std::optional<bool> number =
          is_number(with_level(plan, base, tried, a, k), axis.path, *read->value, registry);
      if (!number) continue;
      if (*number) convert(axis.levels, read->dimension);
      break;
    }
  }
}

}  // namespace withy::campaign
