#include "withy/campaign/si_levels.hpp"

#include <algorithm>
#include <optional>

#include "withy/campaign/derived.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/units.hpp"

namespace withy::campaign {
namespace {

std::optional<AnyQuantity> quantity_of(const Value& value) {
  if (value.kind() != Value::Kind::text) return {};
  const AnyQuantity read = read_any_quantity(value.text());
  return read.value ? std::optional(read) : std::nullopt;
}

/// The first level that is a quantity; null where there is none.
const Value* first_quantity(const Levels& levels) {
  const auto at = std::find_if(levels.values.begin(), levels.values.end(), quantity_of);
  return at == levels.values.end() ? nullptr : &*at;
}

/// Whether the scene can be made with a number at a path: one where names are meant cannot.
bool takes(SceneValues values, const std::string& path, double number, Registry& registry) try {
  values.set(path, Value(number), path);
  static_cast<void>(make_scene(values, registry));
  return true;
} catch (const SceneError&) {
  return false;
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

void use_si(Plan& plan, const SceneValues& base, Registry& registry) try {
  SceneValues values = base;
  bool any = false;
  for (const Axis& axis : plan.axes) {
    const Value* quantity = first_quantity(axis.levels);
    any = any || quantity != nullptr;
    values.set(axis.path,
               axis.drawn()          ? Value(axis.distribution.quantile(0.5))
               : quantity != nullptr ? *quantity
                                     : axis.levels.at(0),
               plan.file);
  }
  if (!any) return;
  const Scene scene = make_scene(values, registry);
  for (Axis& axis : plan.axes) {
    const Value* first = first_quantity(axis.levels);
    if (first == nullptr) continue;
    const AnyQuantity read = *quantity_of(*first);
    // Numbers whose unit is known with a hinge, as those it starts with, stand in the checked scene as they were
    // written.
    const std::optional<double> number = number_at(scene.source, axis.path);
    if (number == read.value || (!number && takes(values, axis.path, *read.value, registry)))
      convert(axis.levels, read.dimension);
  }
} catch (const SceneError&) {
  // Cases say what is wrong with them; here the values stay as the plan has them.
}

}  // namespace withy::campaign
