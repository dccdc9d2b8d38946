#include "withy/results/plugin_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/text_table.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

template <class Interface>
bool describe_as(Registry& registry, const std::string& kind, const std::string& id, PluginDescription& out) {
  if (kind != kind_name<Interface>()) return false;
  if (const Plugin<Interface>* plugin = registry.find<Interface>(id)) out = {plugin->summary, plugin->parameters};
  return true;
}

template <class... Interfaces>
PluginDescription described_as_any(Registry& registry, const std::string& kind, const std::string& id) {
  PluginDescription description;
  static_cast<void>((describe_as<Interfaces>(registry, kind, id, description) || ...));
  return description;
}

Json plugin_json(const PluginEntry& plugin) {
  Json j{{"kind", plugin.kind}, {"id", plugin.id}, {"file", plugin.file.string()}, {"version", plugin.version}};
  j["state"] = plugin.refused.empty() ? "loaded" : "refused";
  if (!plugin.refused.empty()) {
    j["reason"] = plugin.refused;
    return j;
  }
  j["summary"] = plugin.about.summary;
  j["options"] = Json::array();
  for (const ParameterSpec& p : plugin.about.parameters) j["options"].push_back(parameter_json(p));
  return j;
}

void add_options(std::string& out, const std::vector<Json>& options, const std::string& indent) {
  for (const Json& o : options) {
    std::string notes;
    for (const char* key : {"unit", "unit_sliding", "default", "above", "least", "most", "choices", "count", "columns"})
      if (o.contains(key) && o[key] != "1") notes += fmt::format(", {} {}", key, plain_text(o[key]));
    out += fmt::format("{}{} ({}{}{})\n{}    {}\n", indent, o["key"].get<std::string>(), o["kind"].get<std::string>(),
                       o["required"].get<bool>() ? ", required" : "", notes, indent, o["meaning"].get<std::string>());
    if (o.contains("members")) add_options(out, o["members"], indent + "  ");
  }
}

}  // namespace

PluginDescription described(Registry& registry, const std::string& kind, const std::string& id) {
  return described_as_any<Body, Hinge, ModeFamily, Formulation, Integrator, Load, Motion, StrainKinematics, Sensor>(
      registry, kind, id);
}

Json plugins_json(const std::vector<PluginEntry>& plugins) {
  std::vector<Json> all;
  for (const PluginEntry& plugin : plugins) all.push_back(plugin_json(plugin));
  return all;
}

std::string plugins_table(const std::vector<PluginEntry>& plugins) {
  TextTable table({"<kind", "<id", "<version", "<library", "<what it is"});
  std::string refused;
  for (const PluginEntry& p : plugins) {
    if (!p.refused.empty())
      refused += (p.id.empty() ? "" : p.kind + '/' + p.id + ": ") + p.refused + '\n';
    else
      table.add({p.kind, p.id, p.version, p.file.filename().string(), std::string(p.about.summary)});
  }
  return table.str() + (refused.empty() ? "" : "\nrefused:\n" + refused);
}

std::string plugin_text(const PluginEntry& plugin) {
  std::string out =
      fmt::format("{}/{}  version {}\n{}\n", plugin.kind, plugin.id, plugin.version, plugin.file.string());
  if (!plugin.refused.empty()) return out + "refused: " + plugin.refused + '\n';
  out += plugin.about.summary;
  out += '\n';
  if (!plugin.about.parameters.empty()) out += "options:\n";
  add_options(out, plugin_json(plugin)["options"], "  ");
  return out;
}

}  // namespace withy
