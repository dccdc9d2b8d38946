#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/text_table.hpp"

namespace withy::app {
namespace {

struct PluginsArguments : CommonArguments {
  std::string name;  ///< id or kind/id; empty: all
};

using Json = nlohmann::ordered_json;

/// What a plugin of any kind says of itself.
struct Description {
  std::string summary;
  std::vector<ParameterSpec> parameters;
};

template <class Interface>
bool describe_as(Registry& registry, const PluginRecord& record, Description& out) {
  if (record.kind != kind_name<Interface>()) return false;
  if (const Plugin<Interface>* plugin = registry.find<Interface>(record.id))
    out = {plugin->summary, plugin->parameters};
  return true;
}

/// Loads the plugin's library. \throws PluginError where it is refused.
Description describe(Registry& registry, const PluginRecord& r) {
  Description d;
  static_cast<void>(describe_as<Body>(registry, r, d) || describe_as<Hinge>(registry, r, d) ||
                    describe_as<ModeFamily>(registry, r, d) || describe_as<Formulation>(registry, r, d) ||
                    describe_as<Integrator>(registry, r, d) || describe_as<Load>(registry, r, d) ||
                    describe_as<Motion>(registry, r, d) || describe_as<StrainKinematics>(registry, r, d) ||
                    describe_as<Sensor>(registry, r, d));
  return d;
}

/// The plugins found, after an attempt to load each that is wanted: only then is it known which are refused.
std::vector<PluginRecord> load_wanted(const Plugins& plugins, const std::string& name) {
  const auto wanted = [&](const PluginRecord& r) {
    return name.empty() || r.id == name || r.kind + '/' + r.id == name;
  };
  for (const PluginRecord& r : plugins.host().plugins()) {
    if (r.state != PluginRecord::State::available || !wanted(r)) continue;
    try {
      static_cast<void>(describe(plugins.registry(), r));
    } catch (const PluginError&) {
      // The host has recorded why; it is shown with the others.
    }
  }
  std::vector<PluginRecord> records = plugins.host().plugins();
  std::erase_if(records, [&](const PluginRecord& r) { return !wanted(r); });
  return records;
}

Json record_json(const Plugins& plugins, const PluginRecord& r) {
  Json j{{"kind", r.kind}, {"id", r.id}, {"file", r.file.string()}, {"version", r.version}};
  j["state"] = r.state == PluginRecord::State::refused ? "refused" : "loaded";
  if (r.state == PluginRecord::State::refused) {
    j["reason"] = r.reason;
    return j;
  }
  const Description d = describe(plugins.registry(), r);
  j["summary"] = d.summary;
  j["options"] = Json::array();
  for (const ParameterSpec& p : d.parameters) j["options"].push_back(parameter_json(p));
  return j;
}

std::string list_text(const std::vector<PluginRecord>& records) {
  TextTable table({"<kind", "<id", "<version", "<library", "<what it is"});
  std::string refused;
  for (const PluginRecord& r : records) {
    if (r.state == PluginRecord::State::refused)
      refused += (r.id.empty() ? "" : r.kind + '/' + r.id + ": ") + r.reason + '\n';
    else
      table.add({r.kind, r.id, r.version, r.file.filename().string(), r.summary});
  }
  return table.str() + (refused.empty() ? "" : "\nrefused:\n" + refused);
}

void add_options(std::string& out, const std::vector<Json>& options, const std::string& indent) {
  for (const Json& o : options) {
    std::string notes;
    for (const char* key : {"unit", "default", "above", "least", "most", "choices", "count", "columns"})
      if (o.contains(key) && o[key] != "1") notes += fmt::format(", {} {}", key, plain_text(o[key]));
    out += fmt::format("{}{} ({}{}{})\n{}    {}\n", indent, o["key"].get<std::string>(), o["kind"].get<std::string>(),
                       o["required"].get<bool>() ? ", required" : "", notes, indent, o["meaning"].get<std::string>());
    if (o.contains("members")) add_options(out, o["members"], indent + "  ");
  }
}

std::string description_text(const Json& plugin) {
  std::string out =
      fmt::format("{}/{}  version {}\n{}\n", plugin["kind"].get<std::string>(), plugin["id"].get<std::string>(),
                  plugin["version"].get<std::string>(), plugin["file"].get<std::string>());
  if (plugin.contains("reason")) return out + "refused: " + plugin["reason"].get<std::string>() + '\n';
  out += plugin["summary"].get<std::string>() + '\n';
  if (!plugin["options"].empty()) out += "options:\n";
  add_options(out, plugin["options"], "  ");
  return out;
}

ExitStatus plugins(const PluginsArguments& arguments) {
  const Plugins plugins(arguments);
  const std::vector<PluginRecord> records = load_wanted(plugins, arguments.name);
  if (records.empty()) {
    throw InputError(arguments.name.empty() ? "no plugins were found in " + PluginHost::default_directory().string()
                                            : "no plugin is called '" + arguments.name + "'; see withy plugins");
  }
  if (arguments.name.empty() && !arguments.json) {
    print(list_text(records));
    return ExitStatus::done;
  }
  std::vector<Json> all;
  for (const PluginRecord& r : records) all.push_back(record_json(plugins, r));
  if (arguments.json) {
    print(json_text(Json(all)));
  } else {
    for (const Json& plugin : all) print(description_text(plugin));
  }
  return ExitStatus::done;
}

std::function<ExitStatus()> add_plugins(CLI::App& c) {
  const auto arguments = std::make_shared<PluginsArguments>();
  PluginsArguments& a = *arguments;
  c.add_option("NAME", a.name, "Id of a plugin, or kind/id");
  add_common(c, a);
  return [arguments] { return plugins(*arguments); };
}

}  // namespace

const Command plugins_command = {"plugins", "List the plugins found, or describe one with its options",
                                 "  withy plugins\n"
                                 "  withy plugins quadratic",
                                 &add_plugins};

}  // namespace withy::app
