#include "withy/study/written_angles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy::study {
namespace {

bool is_beyond_a_turn(const Value& x) {
  return x.kind() == Value::Kind::number && std::abs(x.number()) > 2 * std::numbers::pi;
}

/// Whoever means radians mostly writes a multiple of pi.
bool is_of_fives(const Value& x) { return x.kind() == Value::Kind::number && std::remainder(x.number(), 5) == 0; }

void remark_on_angle(const Value& angle, std::vector<Remark>& all) {
  const double x = angle.number();
  all.push_back({angle.place(), fmt::format("an angle of {0} rad is {1} turns: a number without a unit is in radians; "
                                            "are degrees meant? Then write \"{0} deg\"",
                                            brief(x), brief(x / (2 * std::numbers::pi)))});
}

/// An angle as it was written without a unit.
void look_at_angle(const Value& angle, std::vector<Remark>& all) {
  if (is_beyond_a_turn(angle) && is_of_fives(angle)) remark_on_angle(angle, all);
}

/// A column of a table, of which all must look like degrees; its first beyond a turn is remarked on.
void look_at_column(const Value& rows, std::size_t column, std::vector<Remark>& all) {
  const Value* first = nullptr;
  for (const Value& row : rows.items()) {
    if (row.items().size() <= column || !is_of_fives(row.items()[column])) return;
    if (first == nullptr && is_beyond_a_turn(row.items()[column])) first = &row.items()[column];
  }
  if (first != nullptr) remark_on_angle(*first, all);
}

/// Angles of orientations, wherever they stand.
void look_at_orientations(const Value& value, std::vector<Remark>& all) {
  const auto look = [&](const Value& angle) {
    if (is_beyond_a_turn(angle)) remark_on_angle(angle, all);
  };
  if (const Value* angle = value.find("angle"); angle != nullptr && value.has("axis")) look(*angle);
  if (const Value* angles = value.find("xyz"))
    for (const Value& angle : angles->items()) look(angle);
  for (const Value& item : value.items()) look_at_orientations(item, all);
  for (const auto& [name, member] : value.members()) look_at_orientations(member, all);
}

/// What plugins of loads and motions ask for, looked at by its units: "rad|m" is of a hinge.
class WrittenAngles {
 public:
  WrittenAngles(const Prepared& prepared, Registry& registry, std::vector<Remark>& all)
      : prepared_(prepared), registry_(registry), all_(all) {}

  void look_at_loads(const Value& loads) const {
    for (const auto& [name, load] : loads.members())
      if (const auto* plugin = of_type<Load>(load)) look_at(plugin->parameters, load, turns(measured_hinge(load)));
  }
  void look_at_motions(const Value& motions) const {
    for (const auto& [name, motion] : motions.members())
      if (const auto* plugin = of_type<Motion>(motion)) look_at(plugin->parameters, motion, turns(hinge_in(motion)));
  }
  void look_at_events(const Value& events) const {
    for (const auto& [name, event] : events.members()) {
      const Value *value = event.find("value"), *signal = event.find("signal"), *of = event.find("of");
      const bool rate = of != nullptr && of->kind() == Value::Kind::text && of->text() == "rate";
      const std::string hinge = signal != nullptr ? signal->text() : hinge_in(event);
      if (value != nullptr && !rate && turns(hinge)) look_at_angle(*value, all_);
    }
  }
  void look_at_start(const Value& initial) const {
    const Value* hinges = initial.find("hinges");
    if (hinges == nullptr) return;
    for (const auto& [hinge, state] : hinges->members()) {
      const Value* position = state.find("position");
      if (position == nullptr || !turns(hinge)) continue;
      look_at_angle(*position, all_);  // a number alone
      for (const Value& angle : position->items()) look_at_angle(angle, all_);
    }
  }

 private:
  template <class Interface>
  const Plugin<Interface>* of_type(const Value& given) const {
    const Value* type = given.find("type");
    return type != nullptr && type->kind() == Value::Kind::text ? registry_.find<Interface>(type->text()) : nullptr;
  }
  static std::string hinge_in(const Value& owner) {
    const Value* hinge = owner.find("hinge");
    return hinge != nullptr && hinge->kind() == Value::Kind::text ? hinge->text() : std::string();
  }
  /// The hinge whose coordinate a load measures: a controller's `of`, else the one that it acts on.
  static std::string measured_hinge(const Value& load) {
    const Value* of = load.find("of");
    if (of == nullptr) return hinge_in(load);
    if (of->kind() == Value::Kind::text) return of->text();
    return of->items().size() == 1 && of->items()[0].kind() == Value::Kind::text ? of->items()[0].text() : "";
  }
  /// Whether a name is that of a hinge with one angle.
  bool turns(const std::string& hinge) const {
    for (const HingeNode& node : prepared_.model().hinges()) {
      const std::vector<HingeRate> rates = hinge_rates(*node.hinge);
      if (node.name == hinge) return rates.size() == 1 && rates.front().angular;
    }
    return false;
  }
  static bool is_angle(const std::string& unit, bool turns) { return unit == "rad" || (turns && unit == "rad|m"); }

  void look_at(const std::vector<ParameterSpec>& parameters, const Value& given, bool turns_there) const {
    for (const ParameterSpec& p : parameters)
      if (const Value* value = given.find(p.key)) look_at(p, *value, turns_there);
  }
  void look_at(const ParameterSpec& p, const Value& value, bool turns_there) const {
    using Kind = ParameterSpec::Kind;
    if (p.kind == Kind::map) look_at(p.members, value, turns_there);
    if (p.kind == Kind::named)
      for (const auto& [name, member] : value.members()) look_at(p.members, member, turns(name));
    if (p.refers == ParameterSpec::Refers::motion)
      if (const auto* plugin = of_type<Motion>(value)) look_at(plugin->parameters, value, turns_there);
    if (p.kind == Kind::number && is_angle(p.unit, turns_there)) {
      look_at_angle(value, all_);
      look_at_column(value, 1, all_);
    }
    for (std::size_t c = 0; p.kind == Kind::table && c < p.columns.size(); ++c)
      if (is_angle(p.columns[c], turns_there)) look_at_column(value, c, all_);
  }

  const Prepared& prepared_;
  Registry& registry_;
  std::vector<Remark>& all_;
};

}  // namespace

void look_at_written_angles(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Value& root = prepared.values.root();
  look_at_orientations(root, all);
  const WrittenAngles angles(prepared, registry, all);
  if (const Value* loads = root.find("loads")) angles.look_at_loads(*loads);
  if (const Value* motions = root.find("motions")) angles.look_at_motions(*motions);
  if (const Value* events = root.find("events")) angles.look_at_events(*events);
  if (const Value* initial = root.find("initial")) angles.look_at_start(*initial);
}

}  // namespace withy::study
