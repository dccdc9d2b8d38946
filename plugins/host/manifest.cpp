#include "withy/plugins/host/manifest.hpp"

#include <algorithm>
#include <boost/property_tree/ini_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <regex>
#include <sstream>

#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// No manifest comes near it; a greater file is no manifest.
constexpr std::uintmax_t most_bytes = 64 * 1024;

std::string kinds() {
  std::string text;
  for (const std::string_view kind : plugin_kinds) text += (text.empty() ? "" : ", ") + std::string(kind);
  return text;
}

std::vector<std::string> read_provides(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream words(text);
  for (std::string name; words >> name;) {
    const std::size_t slash = name.find('/');
    const std::string kind = name.substr(0, slash);
    if (slash == std::string::npos || std::find(plugin_kinds.begin(), plugin_kinds.end(), kind) == plugin_kinds.end()) {
      throw PluginError("'" + name + "' under provides is not kind/id with a kind among " + kinds());
    }
    if (!is_plugin_id(name.substr(slash + 1))) {
      throw PluginError("the id in '" + name + "' under provides is not 1 to 64 of a-z, 0-9 and '-'");
    }
    names.push_back(name);
  }
  if (names.empty()) throw PluginError("nothing is named under provides");
  std::sort(names.begin(), names.end());
  if (const auto twice = std::adjacent_find(names.begin(), names.end()); twice != names.end()) {
    throw PluginError("'" + *twice + "' is twice under provides");
  }
  return names;
}

Manifest parse(const std::filesystem::path& file) {
  if (std::filesystem::file_size(file) > most_bytes) throw PluginError("it is too long");
  boost::property_tree::ptree tree;
  boost::property_tree::read_ini(file.string(), tree);
  const auto section = tree.find("withy-plugin");
  if (tree.size() != 1 || section == tree.not_found()) {
    throw PluginError("it does not consist of one section [withy-plugin]");
  }
  Manifest manifest;
  std::string provides;
  const std::vector<std::pair<std::string, std::string*>> keys = {{"library", &manifest.library},
                                                                  {"entry", &manifest.entry},
                                                                  {"provides", &provides},
                                                                  {"version", &manifest.version}};
  for (const auto& [key, value] : section->second) {
    const auto it = std::find_if(keys.begin(), keys.end(), [&k = key](const auto& known) { return known.first == k; });
    if (it == keys.end()) throw PluginError("the key '" + key + "' is unknown");
    *it->second = value.data();
  }
  for (const auto& [key, value] : keys) {
    if (value->empty()) throw PluginError("the key '" + key + "' is missing or empty");
  }
  if (const std::filesystem::path library = manifest.library;
      library.has_parent_path() || library == "." || library == "..") {
    throw PluginError("'" + manifest.library + "' under library is not the plain name of a file");
  }
  if (!std::regex_match(manifest.entry, std::regex("withy_plugin_[a-z0-9_]{1,64}"))) {
    throw PluginError("'" + manifest.entry + "' under entry is not a symbol withy_plugin_<name>");
  }
  manifest.provides = read_provides(provides);
  return manifest;
}

}  // namespace

Manifest read_manifest(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    return PluginError("the manifest " + file.string() + " is malformed: " + why);
  };
  try {
    return parse(file);
  } catch (const boost::property_tree::ini_parser_error& e) {
    throw refuse("line " + std::to_string(e.line()) + ": " + e.message());
  } catch (const PluginError& e) {
    throw refuse(e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    throw PluginError("the manifest " + file.string() + " cannot be read: " + e.code().message());
  }
}

}  // namespace withy
