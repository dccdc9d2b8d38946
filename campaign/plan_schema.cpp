#include "withy/campaign/plan_schema.hpp"

#include <nlohmann/json.hpp>

#include "withy/campaign/plan_reader.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

Json reference_to(const char* definition) { return {{"$ref", std::string("#/$defs/") + definition}}; }

Json described(Json json, const char* meaning) {
  json["description"] = meaning;
  return json;
}

Json one_of(const std::vector<std::string>& names) { return {{"enum", names}}; }

/// A map of these members, of one form each, of which the first `required` must be there.
Json members(const std::vector<std::string>& names, const Json& form, std::size_t required) {
  Json properties = Json::object();
  for (const std::string& name : names) properties[name] = form;
  Json json = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  for (std::size_t i = 0; i < required; ++i) json["required"].push_back(names[i]);
  return json;
}

Json whole(double least) { return {{"type", "integer"}, {"minimum", least}}; }

Json names() { return {{"type", "array"}, {"items", {{"type", "string"}}}}; }

/// What an axis may be; one member.
Json axis() {
  Json range = members(keys::range, reference_to("number"), 3);
  range["properties"]["count"] = whole(2);
  const Json list = {{"anyOf", {{{"type", "string"}}, members(keys::list, {{"type", "string"}}, 1)}}};
  Json inner = members(keys::distributions, reference_to("normal"), 0);
  inner["properties"]["uniform"] = reference_to("uniform");
  inner["minProperties"] = inner["maxProperties"] = 1;
  const Json spread = {{"anyOf", {reference_to("uniform"), inner}}};
  Json json = members(keys::axis, reference_to("normal"), 0);
  json["minProperties"] = json["maxProperties"] = 1;
  Json& p = json["properties"];
  p["grid"] = described({{"anyOf", {{{"type", "array"}, {"minItems", 1}}, range}}}, "each of these values");
  p["list"] = described(list, "the values of a column of a CSV file; columns of one file go together");
  p["uniform"] = reference_to("uniform");
  p["latin"] = described(spread, "drawn from equal shares, one value from each (Latin hypercube)");
  p["sobol"] = described(spread, "drawn by a Sobol sequence, shifted at random");
  return json;
}

}  // namespace

std::string plan_schema() {
  const Json number = {{"anyOf", {{{"type", "number"}}, {{"type", "string"}}}},
                       {"description", "in SI units, or with its unit"}};
  Json design = members(keys::design, whole(2), 1);
  design["properties"]["type"] = one_of(keys::designs);
  Json correlation = members(keys::correlation, names(), 2);
  correlation["properties"]["matrix"] = {{"type", "array"},
                                         {"items", {{"type", "array"}, {"items", {{"type", "number"}}}}}};
  Json plan = members(keys::plan, Json::object(), 0);
  Json& p = plan["properties"];
  p["format"] = {{"const", "withy-sweep/1"}};
  p["name"] = {{"type", "string"}};
  p["scene"] = described({{"type", "string"}}, "file of the scene, relative to the plan");
  p["set"] = described({{"type", "object"}}, "values by their paths, for every case");
  p["vary"] = {{"type", "object"},
               {"minProperties", 1},
               {"additionalProperties", reference_to("axis")},
               {"description", "what varies, by its path in the scene"}};
  p["cases"] = described(whole(1), "draws for each point of the grids; trajectories; samples");
  p["seed"] = described(whole(0), "of all random numbers");
  p["derived"] = {{"type", "object"},
                  {"additionalProperties", {{"type", "string"}}},
                  {"description", "values that follow from others, by their paths: formulas"}};
  Json history = members(keys::history, names(), 1);
  history["properties"]["every"] = described(reference_to("number"), "s; default: the scene's time.output");
  p["keep"] = described(members(keys::keep, names(), 0), "results that the table has of each case");
  p["keep"]["properties"]["history"] =
      described({{"anyOf", {names(), history}}}, "results over time, for percentiles over the cases");
  p["correlation"] = described(correlation, "correlations of values that are drawn");
  p["design"] = described({{"anyOf", {one_of(keys::designs), design}}}, "which cases there are");
  p["failures"] = described(one_of(keys::failures), "what a case that does not come to its end does to the others");
  p["evaluation"] = described(one_of(keys::evaluations),
                              "whether cases that differ in numbers only are evaluated four or eight at once");
  plan["required"] = {"format", "scene", "vary"};
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Withy sweep"}};
  schema.update(plan);
  schema["$defs"] = {{"number", number},
                     {"uniform", members(keys::uniform, reference_to("number"), 2)},
                     {"normal", members(keys::normal, reference_to("number"), 2)},
                     {"axis", axis()}};
  return schema.dump(2);
}

}  // namespace withy::campaign
