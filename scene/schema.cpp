#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/orientation.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/value_json.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;
using Specs = std::vector<ParameterSpec>;

// As Checker: a decimal number and a unit.
constexpr const char* quantity_pattern =
    "^[-+]?((0|[1-9][0-9]*)([.][0-9]*)?|[.][0-9]+)([eE][-+]?[0-9]+)? *[^-+.0-9eE "
    "].*$|^[-+]?(0|[1-9][0-9]*)([.][0-9]*)? *1/.*$";
constexpr const char* name_pattern = "^(?!world$)[A-Za-z_][A-Za-z0-9_-]{0,63}$";
constexpr const char* output_pattern = "^(?!world$)[A-Za-z_][A-Za-z0-9_.@-]*$";  // those that say what they are, too

Json reference(const char* definition) { return {{"$ref", std::string("#/$defs/") + definition}}; }

/// Makes the schema of everything one registry can read.
class SchemaWriter {
 public:
  SchemaWriter(Registry& registry, const std::function<void(const std::string&)>& left_out)
      : registry_(registry), left_out_(left_out) {}

  Json scene() {
    Json properties = members(grammar::scene_members())["properties"];
    properties["formulation"] = choice<Formulation>("formulation", grammar::default_formulation);
    properties["integrator"] = choice<Integrator>("integrator", grammar::default_integrator);
    properties["bodies"] = plugins<Body>(grammar::body_members(), "bodies of the tree");
    properties["bodies"]["type"] = "object";
    properties["bodies"]["minProperties"] = 1;
    properties["hinges"] = plugins<Hinge>(grammar::hinge_members(), "hinges; each body is the child of exactly one");
    properties["hinges"]["type"] = "object";
    properties["loads"] = plugins<Load>(grammar::load_members(), "loads on the tree");
    properties["motions"] = plugins<Motion>(grammar::motion_members(), "prescribed motions of hinges");
    properties["constraints"] = {
        {"type", map_or_nothing()},
        {"description", "hinges that close loops beyond the tree"},
        {"propertyNames", reference("name")},
        {"additionalProperties", {{"anyOf", alternatives<Hinge>("hinge", grammar::constraint_members())}}}};
    properties["initial"] = state();
    Json guess = state();
    guess["description"] = "where closing the loops of constraints begins, for coordinates that the state does not say";
    properties["initial"]["properties"]["guess"] = std::move(guess);
    properties["outputs"] = plugins<Sensor>(grammar::sensor_members(), "sensors, whose numbers are results");
    properties["outputs"]["propertyNames"] = {{"type", "string"}, {"pattern", output_pattern}};
    return {
        {"$schema", "https://json-schema.org/draft/2020-12/schema"},
        {"title", "Withy scene"},
        {"type", "object"},
        {"required", {"format", "bodies", "hinges"}},
        {"additionalProperties", false},
        {"properties", properties},
        {"$defs",
         {{"quantity", {{"type", "string"}, {"pattern", quantity_pattern}, {"description", "a number with its unit"}}},
          {"numbers", {{"type", "array"}, {"items", number_or_quantity({{"type", "number"}})}}},
          {"mode-family", mode_family()},
          {"formulation", own_formulation()},
          {"motion", motion()},
          {"name", {{"type", "string"}, {"pattern", name_pattern}}}}}};
  }

 private:
  /// Null where the library is refused.
  template <class Interface>
  const Plugin<Interface>* at_hand(const std::string& id) {
    try {
      return registry_.find<Interface>(id);
    } catch (const PluginError& e) {
      if (told_.insert(e.what()).second && left_out_) left_out_(e.what());
      return nullptr;
    }
  }

  /// Of the plugins at hand: a library is known to be refused only after an attempt to load it.
  template <class Interface>
  std::vector<std::string> ids() {
    std::vector<std::string> all = registry_.ids<Interface>();
    std::erase_if(all, [this](const std::string& id) { return at_hand<Interface>(id) == nullptr; });
    return all;
  }

  /// Nothing is an empty map where one may be empty.
  static Json map_or_nothing() { return Json::array({"object", "null"}); }

  static Json number_or_quantity(Json number) {
    return {{"anyOf", Json::array({std::move(number), reference("quantity")})}};
  }

  static Json bounded(const ParameterSpec& spec, const char* type) {
    Json json = {{"type", type}};
    if (spec.minimum) json[spec.exclusive_minimum ? "exclusiveMinimum" : "minimum"] = *spec.minimum;
    if (spec.maximum) json["maximum"] = *spec.maximum;
    return json;
  }

  Json word(const ParameterSpec& spec) {
    if (!spec.unit.empty()) return {{"type", {"string", "number"}}};
    if (spec.refers == ParameterSpec::Refers::mode_family) return reference("mode-family");
    if (spec.refers == ParameterSpec::Refers::formulation) return reference("formulation");
    if (spec.refers == ParameterSpec::Refers::motion) return reference("motion");
    Json json = {{"type", "string"}};
    if (spec.refers == ParameterSpec::Refers::strain_kinematics) json["enum"] = ids<StrainKinematics>();
    if (!spec.choices.empty() && spec.refers == ParameterSpec::Refers::nothing) json["enum"] = spec.choices;
    return json;
  }

  static Json row(const Json& item, std::size_t count) {
    Json json = {{"type", "array"}, {"items", item}};
    if (count != 0) json["minItems"] = json["maxItems"] = count;
    return json;
  }

  /// A table; the schema does not tell its columns apart, so that a range of the others is left to the reader.
  static Json rows(const ParameterSpec& spec) {
    return {{"type", "array"}, {"items", row(number_or_quantity({{"type", "number"}}), spec.count)}, {"minItems", 1}};
  }

  Json kind(const ParameterSpec& spec) {
    using enum ParameterSpec::Kind;
    const auto quantity = [&] { return number_or_quantity(bounded(spec, "number")); };
    switch (spec.kind) {
      case number: {
        if (spec.columns.empty()) return quantity();
        Json alternatives = quantity();
        alternatives["anyOf"].push_back(rows(spec));
        return alternatives;
      }
      case integer:
        return bounded(spec, "integer");
      case boolean:
        return {{"type", "boolean"}};
      case text:
        return word(spec);
      case vector:
        if (is_orientation(spec)) return orientation();
        return row(quantity(), spec.count);
      case table:
        return rows(spec);
      case map:
        return members(spec.members);
      case named:
        return {{"type", map_or_nothing()},
                {"propertyNames", reference("name")},
                {"additionalProperties", members(spec.members)}};
      case matrix: {
        Json line = row(quantity(), 0);
        line["minItems"] = 1;
        return {{"type", "array"}, {"items", std::move(line)}, {"minItems", 1}};
      }
      case texts: {
        const Json one = word(spec);
        return {{"anyOf", Json::array({one, {{"type", "array"}, {"items", one}, {"minItems", 1}}})}};
      }
    }
    return {};
  }

  /// A quaternion, or one of the maps that say the same.
  Json orientation() {
    Json forms = Json::array({row(number_or_quantity({{"type", "number"}}), 4)});
    for (const Specs& form : orientation_forms()) forms.push_back(members(form));
    return {{"anyOf", forms}};
  }

  Json described(const ParameterSpec& spec) {
    Json json = kind(spec);
    const bool has_unit = !spec.unit.empty() && spec.unit != "1";
    json["description"] = spec.meaning + (has_unit ? fmt::format(" [{}]", unit_text(spec.unit)) : "");
    if (spec.fallback) json["default"] = value_json(*spec.fallback);
    return json;
  }

  Json members(const Specs& specs) {
    Json properties = Json::object();
    Json required = Json::array();
    for (const ParameterSpec& s : specs) {
      properties[s.key] = described(s);
      if (s.required) required.push_back(s.key);
    }
    Json json = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    json["type"] = required.empty() ? map_or_nothing() : Json("object");
    if (!required.empty()) json["required"] = required;
    return json;
  }

  /// One alternative for each plugin of a kind, told apart by the id under `key`.
  template <class Interface>
  Json alternatives(const std::string& key, const Specs& common) {
    Json list = Json::array();
    for (const std::string& id : registry_.ids<Interface>()) {
      const Plugin<Interface>* plugin = at_hand<Interface>(id);
      if (plugin == nullptr) continue;
      Specs specs = common;
      specs.insert(specs.end(), plugin->parameters.begin(), plugin->parameters.end());
      Json json = members(specs);
      json["description"] = plugin->summary;
      json["properties"][key] = {{"const", id}, {"description", plugin->summary}};
      list.push_back(std::move(json));
    }
    return list;
  }

  template <class Interface>
  Json plugins(const Specs& common, const char* description) {
    return {{"type", map_or_nothing()},
            {"description", description},
            {"propertyNames", reference("name")},
            {"additionalProperties", {{"anyOf", alternatives<Interface>("type", common)}}}};
  }

  template <class Interface>
  Json choice(const std::string& key, std::string_view otherwise) {
    Json list = alternatives<Interface>("name", {grammar::choice_name(key, otherwise)});
    // Without a name the options are those of the default plugin.
    for (Json& json : list) {
      if (json["properties"]["name"]["const"] != otherwise) require_name(json);
    }
    list.push_back({{"type", "string"}, {"enum", ids<Interface>()}});
    return {{"description", fmt::format("{} plugin, by name or with options", key)},
            {"default", otherwise},
            {"anyOf", list}};
  }

  Json mode_family() {
    Json list = alternatives<ModeFamily>("name", {grammar::family_name()});
    list.push_back({{"type", "string"}, {"enum", ids<ModeFamily>()}});
    return {{"description", "mode-family plugin, by name or with options"}, {"anyOf", list}};
  }

  /// Of a body alone.
  Json own_formulation() {
    Json list = alternatives<Formulation>("name", {grammar::formulation_name().optional()});
    for (Json& json : list) require_name(json);
    list.push_back({{"type", "string"}, {"enum", ids<Formulation>()}});
    return {{"description", "formulation plugin, by name or with options"}, {"anyOf", list}};
  }
  /// Requires the plugin's name beside its options; kinematics and truncation say theirs (grammar::named_formulation).
  static void require_name(Json& json) {
    if (!json["properties"].contains("truncation")) json["required"].push_back("name");
  }

  Json motion() {
    Json list = alternatives<Motion>("type", {grammar::motion_type()});
    list.push_back({{"type", "string"}, {"enum", ids<Motion>()}});
    return {{"description", "motion plugin, by type or with options"}, {"anyOf", list}};
  }

  /// A hinge's coordinates: numbers, or of one that turns about any axis an orientation or a pose.
  Json position() {
    Json forms = Json::array({reference("numbers"), number_or_quantity({{"type", "number"}})});
    for (const Specs& form : orientation_forms()) forms.push_back(members(form));
    forms.push_back(members(grammar::pose_members()));
    forms.back()["type"] = "object";
    return {{"anyOf", forms}};
  }

  /// As many numbers as there are; where it is one, the number alone too.
  Json list_or_one() {
    return {{"anyOf", Json::array({reference("numbers"), number_or_quantity({{"type", "number"}})})}};
  }

  Json state() {
    const auto part = [rates = list_or_one()](const char* first, const Json& of_first, const char* second) {
      return Json{{"type", map_or_nothing()},
                  {"additionalProperties",
                   {{"type", map_or_nothing()},
                    {"additionalProperties", false},
                    {"properties", {{first, of_first}, {second, rates}}}}}};
    };
    const Json number = number_or_quantity({{"type", "number"}});
    const auto by_name = [](const Json& of_each) {
      return Json{{"type", map_or_nothing()}, {"propertyNames", reference("name")}, {"additionalProperties", of_each}};
    };
    const Json numbers_by_key = {{"type", map_or_nothing()}, {"additionalProperties", number}};
    return {{"type", map_or_nothing()},
            {"description", "state at the start; what is not named is as the loads begin, or at its reference"},
            {"additionalProperties", false},
            {"properties",
             {{"hinges", part("position", position(), "rate")},
              {"bodies", part("modes", list_or_one(), "rates")},
              {"loads", by_name(numbers_by_key)},
              {"held", by_name({{"type", "array"}, {"items", {{"type", "number"}}}})},
              {"inputs", by_name(number)},
              {"locked", {{"type", "array"}, {"items", reference("name")}}},
              {"settings", by_name({{"type", "string"}})},
              {"events", by_name(numbers_by_key)},
              {"time", number},
              {"work", number}}}};
  }

  Registry& registry_;
  const std::function<void(const std::string&)>& left_out_;
  std::set<std::string> told_;
};

}  // namespace

std::string schema(Registry& registry, const std::function<void(const std::string& why)>& left_out) {
  return SchemaWriter(registry, left_out).scene().dump(2);
}

}  // namespace withy
