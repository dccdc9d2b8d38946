#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/plugin_text.hpp"

namespace withy::app {
namespace {

struct PluginsArguments : CommonArguments {
  std::string name;  ///< id or kind/id; empty: all
};

/// The plugins found, after an attempt to load each that is wanted: only then is it known which are refused.
std::vector<PluginEntry> load_wanted(const Plugins& plugins, const std::string& name) {
  const auto wanted = [&](const PluginRecord& r) {
    return name.empty() || r.id == name || r.kind + '/' + r.id == name;
  };
  std::vector<PluginDescription> about;
  for (const PluginRecord& found : plugins.host().plugins()) {
    about.emplace_back();
    if (found.state == PluginRecord::State::refused || !wanted(found)) continue;
    try {
      about.back() = described(plugins.registry(), found.kind, found.id);
    } catch (const PluginError&) {
      // The host has recorded why; it is shown with the others.
    }
  }
  // The same in the same order, with what has become of them.
  std::vector<PluginRecord> now = plugins.host().plugins();
  std::vector<PluginEntry> entries;
  for (std::size_t i = 0; i < now.size(); ++i) {
    PluginRecord& r = now[i];
    if (!wanted(r)) continue;
    const bool refused = r.state == PluginRecord::State::refused;
    entries.push_back({std::move(r.kind), std::move(r.id), std::move(r.file), std::move(r.version),
                       refused ? std::move(r.reason) : "", refused ? PluginDescription() : about[i]});
  }
  return entries;
}

ExitStatus plugins(const PluginsArguments& arguments) {
  const Plugins plugins(arguments);
  const std::vector<PluginEntry> entries = load_wanted(plugins, arguments.name);
  if (entries.empty()) {
    throw InputError(arguments.name.empty() ? "no plugins were found in " + PluginHost::default_directory().string()
                                            : "no plugin is called '" + arguments.name + "'; see withy plugins");
  }
  if (arguments.json) {
    print(json_text(plugins_json(entries)));
  } else if (arguments.name.empty()) {
    print(plugins_table(entries));
  } else {
    for (const PluginEntry& entry : entries) print(plugin_text(entry));
  }
  return ExitStatus::done;
}

void add_plugins(Options& o, PluginsArguments& a) {
  o.argument("NAME", a.name, "Id of a plugin, or kind/id");
  add_common(o, a);
}

}  // namespace

const Command plugins_command = {"plugins", "List the plugins found, or describe one with its options",
                                 "  withy plugins\n"
                                 "  withy plugins quadratic",
                                 &taking<PluginsArguments, add_plugins, plugins>};

}  // namespace withy::app
