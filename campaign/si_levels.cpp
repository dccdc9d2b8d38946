#include "withy/campaign/si_levels.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

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
/// what stands in two of them may not go together. Of other axes the first, or the middle of what is drawn.
SceneValues with_level(const Plan& plan, SceneValues values, const Axis& axis, std::size_t level) {
  for (const Axis& other : plan.axes) {
    const bool beside = !other.drawn() && other.grid == axis.grid;
    set_or_take(values, other.path,
                other.drawn() ? Value(other.distribution.quantile(0.5)) : other.levels.at(beside ? level : 0),
                plan.file);
  }
  return values;
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

void use_si(Plan& plan, const SceneValues& base, Registry& registry) {
  constexpr int wrong_rows = 16;  // each costs a scene, and a list may have a million
  for (Axis& axis : plan.axes) {
    int tried = 0;
    for (std::size_t k = 0; k < axis.levels.size() && tried < wrong_rows; ++k) {
      const std::optional<AnyQuantity> read = quantity_of(axis.levels.at(k));
      if (!read) continue;
      ++tried;
      const std::optional<bool> number = is_number(with_level(plan, base, axis, k), axis.path, *read->value, registry);
      if (!number) continue;
      if (*number) convert(axis.levels, read->dimension);
      break;
    }
  }
}

}  // namespace withy::campaign
