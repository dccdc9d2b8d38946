// The schema holds what the reader checks: every scene of the project conforms to it, bad ones do not.
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "scene_fixture.hpp"
#include "withy/scene/document.hpp"

namespace withy::test {
namespace {

using Json = nlohmann::json;

Json to_json(const Value& v) {
  switch (v.kind()) {
    case Value::Kind::null:
      return nullptr;
    case Value::Kind::boolean:
      return v.boolean();
    case Value::Kind::number:
      return std::floor(v.number()) == v.number() ? Json(static_cast<long>(v.number())) : Json(v.number());
    case Value::Kind::text:
      return v.text();
    case Value::Kind::list: {
      Json list = Json::array();
      for (const Value& item : v.items()) list.push_back(to_json(item));
      return list;
    }
    case Value::Kind::map:
      break;
  }
  Json map = Json::object();
  for (const auto& [key, member] : v.members()) map[key] = to_json(member);
  return map;
}

Json read(const std::string& text) {
  Document document;
  Diagnostics diagnostics;
  if (!read_document(text, {}, document, diagnostics)) throw std::runtime_error("unreadable");
  return to_json(document.root);
}

/// The part of JSON Schema 2020-12 that the schema uses; it throws on keywords it does not know.
class Validator {
 public:
  explicit Validator(const Json& root) : root_(root) {}

  /// The first fault, or nothing.
  std::string fault(const Json& value, const Json& schema, const std::string& path = "") const {
    for (const auto& [keyword, rule] : schema.items()) {
      if (!holds(keyword, rule, value, schema)) return path + " breaks " + keyword + ": " + value.dump().substr(0, 60);
    }
    if (schema.contains("$ref")) {
      if (auto f = fault(value, definition(schema["$ref"]), path); !f.empty()) return f;
    }
    if (value.is_array() && schema.contains("items")) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        if (auto f = fault(value[i], schema["items"], path + "/" + std::to_string(i)); !f.empty()) return f;
      }
    }
    if (!value.is_object()) return {};
    for (const auto& [key, member] : value.items()) {
      const Json* rule = nullptr;
      if (schema.contains("properties") && schema["properties"].contains(key)) {
        rule = &schema["properties"][key];
      } else if (schema.contains("additionalProperties")) {
        rule = &schema["additionalProperties"];
      }
      if (rule == nullptr) continue;
      if (rule->is_boolean()) {
        if (!rule->get<bool>()) return path + "/" + key + " is not allowed";
        continue;
      }
      if (auto f = fault(member, *rule, path + "/" + key); !f.empty()) return f;
    }
    return {};
  }

 private:
  const Json& definition(const std::string& reference) const {
    return root_.at(Json::json_pointer(reference.substr(1)));
  }

  static bool is(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_number_integer();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    throw std::logic_error("type " + type);
  }

  bool holds(const std::string& keyword, const Json& rule, const Json& value, const Json& schema) const {
    static const std::set<std::string> elsewhere = {
        "$schema", "$defs", "$ref", "title", "properties", "items", "description", "additionalProperties", "default"};
    if (elsewhere.count(keyword) != 0) return true;
    if (keyword == "type") {
      const Json types = rule.is_array() ? rule : Json::array({rule});
      return std::any_of(types.begin(), types.end(), [&](const Json& t) { return is(value, t); });
    }
    if (keyword == "const") return value == rule;
    if (keyword == "enum") return std::find(rule.begin(), rule.end(), value) != rule.end();
    if (keyword == "anyOf") {
      return std::any_of(rule.begin(), rule.end(), [&](const Json& s) { return fault(value, s).empty(); });
    }
    if (keyword == "pattern")
      return !value.is_string() || std::regex_search(value.get<std::string>(), std::regex(rule));
    if (keyword == "minimum") return !value.is_number() || value >= rule;
    if (keyword == "exclusiveMinimum") return !value.is_number() || value > rule;
    if (keyword == "maximum") return !value.is_number() || value <= rule;
    if (keyword == "minItems") return !value.is_array() || value.size() >= rule;
    if (keyword == "maxItems") return !value.is_array() || value.size() <= rule;
    if (keyword == "minProperties") return !value.is_object() || value.size() >= rule;
    if (keyword == "maxProperties") return !value.is_object() || value.size() <= rule;
    if (keyword == "required") {
      return !value.is_object() ||
             std::all_of(rule.begin(), rule.end(), [&](const Json& k) { return value.contains(k); });
    }
    if (keyword == "propertyNames") {
      if (!value.is_object()) return true;
      const Json names = value;
      return std::all_of(names.items().begin(), names.items().end(),
                         [&](const auto& item) { return fault(item.key(), rule).empty(); });
    }
    throw std::logic_error("keyword " + keyword + " in " + schema.dump().substr(0, 80));
  }

  const Json& root_;
};

class Schema : public SceneTest {
 protected:
  Schema() : json(Json::parse(withy::schema(registry))), validator(json) {}
  std::string fault(const std::string& text) const { return validator.fault(read(text), json); }
  Json json;
  Validator validator;
};

TEST_F(Schema, NamesItsDraftAndForbidsUnknownKeys) {
  EXPECT_EQ(json["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(json["additionalProperties"], false);
  EXPECT_EQ(json["required"], Json({"format", "bodies", "hinges"}));
}

TEST_F(Schema, HoldsEveryPluginWithItsParameters) {
  std::set<std::string> ids;
  for (const Json& body : json["properties"]["bodies"]["additionalProperties"]["anyOf"]) {
    ids.insert(body["properties"]["type"]["const"]);
    EXPECT_EQ(body["additionalProperties"], false);
    EXPECT_TRUE(body["properties"].contains("frames"));
  }
  const std::vector<std::string> known = registry.ids<Body>();
  EXPECT_EQ(ids, std::set<std::string>(known.begin(), known.end()));
}

// As a host of plugins has it: what could be loaded is listed, until an attempt to load it fails.
TEST_F(Schema, LeavesOutThePluginsOfALibraryThatIsRefusedAndSaysWhyOnce) {
  const std::set<std::string> broken = {"hinge/parab", "load/lead", "load/drag", "strain-kinematics/sk"};
  registry.set_loader(
      [&](Registry&, std::string_view kind, std::string_view id) -> bool {
        if (broken.contains(std::string(kind) + "/" + std::string(id))) throw PluginError("laws.so cannot be read");
        return false;
      },
      [&](std::string_view kind) {
        std::vector<std::string> ids;
        for (const std::string& name : broken)
          if (name.starts_with(std::string(kind) + "/")) ids.push_back(name.substr(kind.size() + 1));
        return ids;
      });
  std::vector<std::string> told;
  EXPECT_EQ(Json::parse(withy::schema(registry, [&](const std::string& why) { told.push_back(why); })), json);
  EXPECT_EQ(told, std::vector<std::string>{"laws.so cannot be read"});
  EXPECT_EQ(Json::parse(withy::schema(registry)), json);
}

TEST_F(Schema, AcceptsEverySceneOfTheProject) {
  for (const char* path : {"scenes/pendulum.yaml", "scenes/two-link-slew.yaml", "scenes/driven-arm.yaml",
                           "scenes/beam-on-base.yaml", "scenes/spacecraft.yaml", "scenes/manipulator-pid.yaml",
                           "tests/reference/arm-1.yaml", "tests/reference/arm-2.yaml", "tests/reference/arm-4.yaml",
                           "tests/reference/beam-on-base.yaml", "tests/reference/spacecraft.yaml"}) {
    EXPECT_EQ(fault(file_text(path)), "") << path;
  }
  EXPECT_EQ(fault(good_scene), "");
  EXPECT_EQ(fault(replaced(good_scene, "length: 0.9", "length: 900 mm")), "");
  EXPECT_EQ(fault(replaced(good_scene, "clamped-free", "{name: clamped-loaded, tip_mass: 2 kg}")), "");
  EXPECT_EQ(fault(replaced(good_scene, "mass_per_length: 1.3", "mass_per_length: [[0, 1.3], [900 mm, 0.5]]")), "");
  const std::string begun = std::string(good_scene) + "initial: {hinges: {shoulder: ";
  EXPECT_EQ(fault(begun + "{position: 30 deg, rate: 0.1}}}\n"), "");
  EXPECT_EQ(fault(begun + "{position: [30 deg], rate: [0.1]}}}\n"), "");
  EXPECT_EQ(fault("integrator: {rtol: 1e-9}\n" + std::string(good_scene)), "");
}

TEST_F(Schema, AcceptsNothingWhereAMapMayBeEmpty) {
  for (const char* key : {"motions", "events", "outputs", "constraints", "initial", "formulation", "integrator"}) {
    const std::string text = std::string(good_scene) + key + ":\n";
    EXPECT_EQ(fault(text), "") << key;
    EXPECT_EQ(problems(text, registry), "") << key;
  }
  const std::string out = "out: {position: [0.0762, 0, 0]}", pose = "parent: world, child: hub}";
  for (const std::string& text :
       {replaced(good_scene, out, "out:"), replaced(good_scene, pose, "offset: null, " + pose),
        good_scene + std::string("initial: {hinges: {shoulder: }, bodies: null, settings: ~}\n")}) {
    EXPECT_EQ(fault(text), "") << text;
    EXPECT_EQ(problems(text, registry), "") << text;
  }
  for (const std::string& text :
       {replaced(good_scene, "0.0762, 0, 0]}", "0.0762, 0, 0], orientation: }"),
        replaced(good_scene, "gravity: [0, -9.81, 0]", "gravity:"), "bodies:\n" + std::string("format: withy/1\n"),
        good_scene + std::string("initial: {hinges: {shoulder: {position: }}}\n")}) {
    EXPECT_NE(fault(text), "") << text;
    EXPECT_NE(problems(text, registry), "") << text;
  }
}

TEST_F(Schema, RefusesWhatTheReaderRefuses) {
  const std::pair<const char*, const char*> changes[] = {
      {"withy/1", "withy/2"},
      {"gravity:", "gravty:"},
      {"length: 0.9", "lenght: 0.9"},
      {"length: 0.9", "length: 0"},
      {"mass: 20.0", "mass: -1"},
      {"mass: 20.0", "mass: \"20\""},
      {"mass: 20.0", "mass: heavy"},
      {"modes: 2", "modes: 2.5"},
      {"clamped-free", "clamped-fre"},
      {"type: beam", "type: beem"},
      {"[0, -9.81, 0]", "[0, -9.81]"},
      {"  hub:\n", "  1hub:\n"},
      {"  hub:\n", "  world:\n"},
      {"output: 0.1", "output: 0"},
      {"law: sine", "law: sinus"},
      {"clamped-free", "{name: clamped-loaded, tip_mas: 2}"},
      {"clamped-free", "{name: clamped-free, tip_mass: 2}"},
      {"clamped-free", "{tip_mass: 2}"},
      {"mass_per_length: 1.3", "mass_per_length: [0, 1.3]"},
      {", child: boom", ""},
      {"mass: 20.0", "mass: 010"},
  };
  for (const auto& [from, to] : changes) {
    const std::string text = replaced(good_scene, from, to);
    EXPECT_NE(fault(text), "") << to;
    EXPECT_NE(problems(text, registry), "") << to;
  }
}

}  // namespace
}  // namespace withy::test
