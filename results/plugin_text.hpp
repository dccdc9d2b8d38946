/// \file
/// Plugins by what they say of themselves, as JSON and in words.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/registry.hpp"

namespace withy {

/// What a plugin of any kind says of itself; the registry it was asked of keeps it.
struct PluginDescription {
  std::string_view summary;
  std::span<const ParameterSpec> parameters;
};
/// Loads the plugin's library. \param kind as "body" \throws PluginError where it is refused
PluginDescription described(Registry& registry, const std::string& kind, const std::string& id);

/// A plugin that was found.
struct PluginEntry {
  std::string kind, id;  ///< empty where its file does not say
  std::filesystem::path file;
  std::string version;
  std::string refused;  ///< why it is not used; empty where it can be
  PluginDescription about;
};

nlohmann::ordered_json plugins_json(const std::vector<PluginEntry>& plugins);
/// A row a plugin; those that are refused below, with the reason.
std::string plugins_table(const std::vector<PluginEntry>& plugins);
/// One plugin with its options.
std::string plugin_text(const PluginEntry& plugin);

}  // namespace withy
