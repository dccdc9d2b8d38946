#include "withy/scene/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/orientation.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {
constexpr double most_exact_integer = 9007199254740992.0;  // 2^53

/// True for what `--set gravity.1=-9.81` makes where the file has no `gravity`. A file itself gives the whole list.
bool are_set_elements(const Value& value, const ParameterSpec& spec) {
  return spec.kind == ParameterSpec::Kind::vector && spec.fallback && spec.fallback->kind() == Value::Kind::list &&
         value.kind() == Value::Kind::map && value.place().line < 0 && !value.members().empty() &&
         std::all_of(value.members().begin(), value.members().end(), [](const auto& member) {
           return std::all_of(member.first.begin(), member.first.end(), [](char c) { return c >= '0' && c <= '9'; });
         });
}

QuantityReading quantity(const std::string& text, const std::string& unit) {
  if (unit == any_unit) {
    AnyQuantity any = read_any_quantity(text);
    return {any.value, std::move(any.problem)};
  }
  QuantityReading turning = read_quantity(text, unit_at_hinge(unit, false));
  return turning.value ? turning : read_quantity(text, unit_at_hinge(unit, true));
}

bool depends_on_hinge(const ParameterSpec& spec) {
  const auto depends = [](const std::string& unit) { return unit.find('|') != std::string::npos; };
  return depends(spec.unit) || std::any_of(spec.columns.begin(), spec.columns.end(), depends);
}

/// A unit with a signal's in the place of that of an angle.
std::string of_signal(std::string unit, const std::string& signal) {
  const bool whole = unit == "rad" || signal.find_first_of(" /") == std::string::npos;
  return unit.replace(unit.find("rad"), 3, whole ? signal : '(' + signal + ')');
}

/// The first name of a list, or the one that there is; empty where there is none.
std::string first_name(const Value* names) {
  if (names == nullptr) return {};
  if (names->kind() == Value::Kind::list) return names->items().empty() ? "" : first_name(&names->items().front());
  return names->kind() == Value::Kind::text ? names->text() : "";
}

/// A plugin that is given by its name alone.
bool is_short_form(const Value& value) { return value.kind() == Value::Kind::text; }

/// A map with the name under `key`, whichever form it is given in.
Value in_long_form(const Value& value, const char* key) {
  return is_short_form(value) ? Value::map({{key, value}}, value.place()) : value;
}

}  // namespace

Checker::Moves Checker::moves(const std::string& hinge, const Value& map) const {
  if (names_ == nullptr) return Moves::turning;
  const Value* component = map.find("component");
  const double rate = component != nullptr && component->kind() == Value::Kind::number ? component->number() : 0;
  return names_->sliding.has(fmt::format("{}.{}", hinge, rate)) ? Moves::sliding : Moves::turning;
}

/// The unit of the first signal or input that is named; empty where it is not known.
std::string Checker::unit_of_signal(const Value& names) const {
  if (names_ == nullptr) return {};
  const auto found = names_->units.find(first_name(&names));
  return found == names_->units.end() ? std::string() : found->second;
}

/// What a map about a hinge or a signal is about; nothing of others, which are about what the map around them is.
std::optional<Checker::Subject> Checker::subject(const Value& map) const {
  const Value *of = map.find("of"), *to = map.find("to");
  const std::string hinge = first_name(map.find("hinge"));
  if (hinge.empty() && of == nullptr) return {};
  const auto known = [](const std::string& unit, const char* turning, const char* sliding) {
    return unit == turning ? Moves::turning : unit == sliding ? Moves::sliding : Moves::either;
  };
  Subject about{Moves::either, Moves::either, {}};
  if (!hinge.empty())
    about.driven = moves(hinge, map);
  else if (to != nullptr)
    about.driven = known(unit_of_signal(*to), "N m", "N");
  if (of == nullptr) {
    about.measured = about.driven;
    return about;
  }
  about.unit = unit_of_signal(*of);
  about.measured = known(about.unit, "rad", "m");
  if (about.measured != Moves::either) about.unit.clear();
  return about;
}

/// A unit as "rad|m" for the map at hand: of efforts by what is driven, of gains by both, of others by what is
/// measured. As it is where that is not known.
std::string Checker::unit_here(const std::string& unit) const {
  if (unit.find('|') == std::string::npos) return unit;
  const auto [measured, driven, signal] = subject_;
  const std::string turning = unit_at_hinge(unit, false);
  const bool effort = turning.starts_with("N m"), gain = effort && turning.find("rad") != std::string::npos;
  if (!signal.empty() && turning.find("rad") != std::string::npos)
    return gain ? gain_of_signal(turning.substr(3), signal, driven) : of_signal(turning, signal);
  const Moves one = effort ? driven : measured;
  if (one == Moves::either || (gain && measured == Moves::either)) return unit;
  if (!gain || measured == driven) return unit_at_hinge(unit, one == Moves::sliding);
  // A force for an angle, or a torque for a length.
  return driven == Moves::sliding ? "N" + turning.substr(3) : "N m" + unit_at_hinge(unit, true).substr(1);
}

/// The unit of a gain, which is that of an effort and then `per` an angle, for a signal in its own unit.
std::string Checker::gain_of_signal(const std::string& per, const std::string& signal, Moves driven) {
  const std::string rest = of_signal(per, signal);
  if (driven == Moves::either) return "N m" + rest + "|N" + rest;
  return (driven == Moves::sliding ? "N" : "N m") + rest;
}

bool Checker::has_unit(const Value& value, const ParameterSpec& spec, bool slides) const {
  ParameterSpec known = spec;
  known.unit = unit_at_hinge(spec.unit, slides);
  return check(value, known).has_value();
}

bool Checker::in_range(double x, const ParameterSpec& spec) {
  if (!std::isfinite(x)) return false;
  if (spec.minimum && (spec.exclusive_minimum ? x <= *spec.minimum : x < *spec.minimum)) return false;
  return !spec.maximum || x <= *spec.maximum;
}

void Checker::key_error(const std::string& path, std::string message) const {
  diagnostics_.error(document_.key_place(path), std::move(message));
}

void Checker::got(const Value& value, const ParameterSpec& spec, const std::string& why) const {
  std::string needed = expectation(spec);
  // Which numbers they are, where their count alone would not tell.
  if (spec.kind == ParameterSpec::Kind::vector && spec.count > 0 && !spec.meaning.empty())
    needed += ": " + spec.meaning + axis_as_list(value);
  diagnostics_.error(value.place(),
                     fmt::format("got {}{}; need {}", shown(value), why.empty() ? "" : ": " + why, needed));
}

void Checker::unknown_plugin(const Value& id, const std::string& kind, const std::vector<std::string>& ids) const {
  const std::string available = "; available: " + (ids.empty() ? std::string("none") : listed(ids));
  if (id.kind() == Value::Kind::map || id.kind() == Value::Kind::list)
    return diagnostics_.error(id.place(),
                              fmt::format("got {}; need the name of a plugin ({}){}", shown(id), kind, available));
  const std::string guess = id.kind() == Value::Kind::text ? known_elsewhere(id.text(), ids) : "";
  diagnostics_.error(id.place(),
                     fmt::format("no {} plugin {}{}{}", kind, shown(id),
                                 guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess), available));
}

std::string Checker::suggest(std::string_view name, const std::vector<std::string>& candidates) const {
  constexpr std::size_t many = 50;
  constexpr int most = 100;
  if (candidates.size() > many && suggested_++ >= most) return {};
  return suggestion(name, candidates);
}

void Checker::no_map(const Value& value, const std::string& expected) const {
  diagnostics_.error(value.place(), fmt::format("got {}; need {}", shown(value), expected));
}

std::optional<Value> Checker::number(const Value& value, const ParameterSpec& spec, const std::string& unit) const {
  double x = 0;
  if (value.kind() == Value::Kind::number) {
    x = value.number();
  } else if (value.kind() == Value::Kind::text && spec.kind != ParameterSpec::Kind::integer) {
    const std::string& t = value.text();
    if (t == "nan" || t == "NaN" || t == "inf" || t == "-inf" || t == "Infinity" || t == "-Infinity") {
      diagnostics_.error(value.place(), fmt::format("got {}; need {}", t, expectation(spec)));
      return {};
    }
    const QuantityReading reading = quantity(t, unit);
    if (!reading.value) {
      got(value, spec, reading.problem);
      return {};
    }
    x = *reading.value;
  } else {
    got(value, spec);
    return {};
  }
  const bool whole =
      spec.kind != ParameterSpec::Kind::integer || (std::floor(x) == x && std::abs(x) <= most_exact_integer);
  if (!in_range(x, spec) || !whole) {
    got(value, spec);
    return {};
  }
  return Value(x, value.place());
}

bool Checker::refers(const Place& place, const std::string& name, ParameterSpec::Refers what) const {
  using enum ParameterSpec::Refers;
  if (what == nothing) return true;
  if (names_ == nullptr) return true;
  if (what == frame && !names_->frames_complete) return true;
  const NameList& known = what == body     ? names_->bodies
                          : what == hinge  ? names_->hinges
                          : what == load   ? names_->loads
                          : what == signal ? names_->signals
                          : what == input  ? names_->loads
                                           : names_->frames;
  if (known.has(name)) return true;
  if (what == signal && known.has(name.substr(0, name.find('.')))) return true;
  if (what == frame) {
    no_frame(place, name, *names_);
  } else {
    diagnostics_.error(place, fmt::format("no {} {}{}", referent(what), in_quotes(name), suggest(name, known.names())));
  }
  return false;
}

void Checker::no_frame(const Place& place, const std::string& name, const SceneNames& names) const {
  const NameList& known = names.places.names().empty() ? names.frames : names.places;
  const bool on_body = names.bodies.has(name.substr(0, name.find('.')));
  diagnostics_.error(place, fmt::format("no frame {}{}{}", in_quotes(name), suggest(name, known.names()),
                                        on_body ? "; frames of the body name its other places" : ""));
}

std::optional<Value> Checker::mode_family(const Value& value) const {
  Made<ModeFamily> made;
  if (check_plugin_map(in_long_form(value, "name"), "name", {grammar::family_name()}, *this, made) == nullptr)
    return {};
  return is_short_form(value) ? value : std::move(made.value);
}

std::optional<Value> Checker::formulation(const Value& value) const {
  Made<Formulation> made;
  if (check_plugin_map(is_short_form(value) ? in_long_form(value, "name") : grammar::named_formulation(value), "name",
                       {grammar::formulation_name()}, *this, made) == nullptr)
    return {};
  return is_short_form(value) ? value : std::move(made.value);
}

std::optional<Value> Checker::motion(const Value& value) const {
  Made<Motion> made;
  if (check_plugin_map(in_long_form(value, "type"), "type", {grammar::motion_type()}, *this, made) == nullptr)
    return {};
  return std::move(made.value);
}

std::optional<Value> Checker::text(const Value& value, const ParameterSpec& spec) const {
  if (spec.refers == ParameterSpec::Refers::mode_family &&
      (value.kind() == Value::Kind::text || value.kind() == Value::Kind::map)) {
    return mode_family(value);
  }
  if (spec.refers == ParameterSpec::Refers::formulation &&
      (value.kind() == Value::Kind::text || value.kind() == Value::Kind::map)) {
    return formulation(value);
  }
  if (spec.refers == ParameterSpec::Refers::motion &&
      (value.kind() == Value::Kind::text || value.kind() == Value::Kind::map)) {
    return motion(value);
  }
  if (!spec.unit.empty() &&
      (value.kind() == Value::Kind::number || (value.kind() == Value::Kind::text && looks_like_number(value.text())))) {
    return number(value, spec, spec.unit);
  }
  if (value.kind() != Value::Kind::text) {
    got(value, spec, value.kind() == Value::Kind::number ? "put text that looks like a number in quotes" : "");
    return {};
  }
  const bool chosen = std::find(spec.choices.begin(), spec.choices.end(), value.text()) != spec.choices.end();
  if (chosen) return value;
  if (!spec.choices.empty() && spec.refers == ParameterSpec::Refers::nothing) {
    const std::string guess = nearest(value.text(), spec.choices);
    got(value, spec, guess.empty() ? "" : fmt::format("did you mean '{}'?", guess));
    return {};
  }
  if (spec.refers == ParameterSpec::Refers::strain_kinematics) {
    if (plugin<StrainKinematics>(value) == nullptr) return {};
    return value;
  }
  if (!refers(value.place(), value.text(), spec.refers)) return {};
  return value;
}

std::optional<Value> Checker::check_members(const Value& value, const std::vector<ParameterSpec>& members) const {
  Value result;
  if (!read_members(value, {&members}, result)) return {};
  return result;
}

bool Checker::read_members(const Value& value, std::initializer_list<const std::vector<ParameterSpec>*> lists,
                           Value& result) const {
  const auto known = [&] {
    std::vector<std::string> keys;
    for (const auto* members : lists)
      for (const ParameterSpec& spec : *members) keys.push_back(spec.key);
    return keys;
  };
  const auto knows = [&](const std::string& key) {
    return std::any_of(lists.begin(), lists.end(), [&](const std::vector<ParameterSpec>* members) {
      return std::any_of(members->begin(), members->end(), [&](const ParameterSpec& spec) { return spec.key == key; });
    });
  };
  if (!is_map(value, [&] { return "a map with " + listed(known()); })) return false;
  result = Value::map({}, value.place());
  bool good = true;
  for (const auto& [key, member] : value.members()) {
    if (knows(key)) continue;
    // In a map in braces a comma ends a value that is not in quotes.
    key_error(member.place().path,
              fmt::format("unknown key {}{}", in_quotes(key),
                          key.ends_with(')') ? "; a formula with a comma needs quotes" : suggestion(key, known())));
    good = false;
  }
  const Subject outside = subject_;  // a motion of a hinge may stand in a map about it
  if (std::optional<Subject> own = subject(value)) subject_ = std::move(*own);
  for (const auto* members : lists)
    for (const ParameterSpec& spec : *members) good = read_member(value, spec, result) && good;
  subject_ = outside;
  result.members().shrink_to_fit();  // it stays as long as the scene
  return good;
}

/// The default of a vector with the elements that operations have set in it; null after reporting.
Value Checker::default_with(const Value& elements, const Value& fallback) const {
  Value whole = placed(fallback, elements.place());
  for (const auto& [key, element] : elements.members()) {
    const auto index = list_index(key, whole.items().size());
    if (!index) {
      diagnostics_.error(elements.place(),
                         fmt::format("got index {}; need 0 to {}", in_quotes(key), whole.items().size() - 1));
      return {};
    }
    whole.items()[*index] = element;
  }
  return whole;
}

/// The member of a specification, or its default.
bool Checker::read_member(const Value& value, const ParameterSpec& spec, Value& result) const {
  if (depends_on_hinge(spec)) {
    ParameterSpec here = spec;
    here.unit = unit_here(spec.unit);
    for (std::string& unit : here.columns) unit = unit_here(unit);
    if (here.unit != spec.unit || here.columns != spec.columns) return read_member(value, here, result);
  }
  const auto path = [&] { return value.place().path + "/" + spec.key; };
  const Value* member = value.find(spec.key);
  Value fallback;
  if (member == nullptr && spec.fallback) {
    fallback = placed(*spec.fallback, {value.place().line, value.place().column, path()});
    member = &fallback;
  }
  Value whole;
  if (member != nullptr && are_set_elements(*member, spec)) {
    whole = default_with(*member, *spec.fallback);
    if (whole.kind() == Value::Kind::null) return false;
    member = &whole;
  }
  if (member == nullptr) {
    if (!spec.required) return true;
    key_error(path(), fmt::format("missing: {}; need {}", spec.meaning, expectation(spec)));
    return false;
  }
  auto checked = check(*member, spec);
  if (checked) result.members().emplace_back(spec.key, std::move(*checked));
  return checked.has_value();
}

std::optional<Value> Checker::check(const Value& value, const ParameterSpec& spec) const {
  switch (spec.kind) {
    case ParameterSpec::Kind::number:
      if (!spec.columns.empty() && value.kind() == Value::Kind::list) {
        ParameterSpec rows = spec;
        rows.kind = ParameterSpec::Kind::table;
        return table(value, rows);
      }
      return number(value, spec, spec.unit);
    case ParameterSpec::Kind::integer:
      return number(value, spec, spec.unit);
    case ParameterSpec::Kind::text:
      return text(value, spec);
    case ParameterSpec::Kind::vector:
      if (value.kind() == Value::Kind::map && is_orientation(spec)) return read_orientation(value, *this);
      return row(value, spec);
    case ParameterSpec::Kind::table:
      return table(value, spec);
    case ParameterSpec::Kind::map:
      return check_members(value, spec.members);
    case ParameterSpec::Kind::named:
      return named(value, spec);
    case ParameterSpec::Kind::matrix:
      return matrix(value, spec);
    case ParameterSpec::Kind::texts:
      return texts(value, spec);
    case ParameterSpec::Kind::boolean:
      break;
  }
  if (value.kind() != Value::Kind::boolean) {
    got(value, spec);
    return {};
  }
  return value;
}

}  // namespace withy
