#include "withy/plugins/host/manifest.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

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
  constexpr const char* blank = " \t";
  for (std::size_t begin = text.find_first_not_of(blank), end = 0; begin != std::string::npos;
       begin = text.find_first_not_of(blank, end)) {
    end = std::min(text.find_first_of(blank, begin), text.size());
    const std::string name = text.substr(begin, end - begin);
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

/// The manifest's text. \throws std::filesystem::filesystem_error; PluginError where it is too long.
std::string text_of(const std::filesystem::path& file) {
  if (std::filesystem::is_other(file)) throw PluginError("it is no file");
  if (std::filesystem::file_size(file) > most_bytes) throw PluginError("it is too long");
  std::ifstream stream(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), {});
  if (!stream)
    throw std::filesystem::filesystem_error("read", file, std::make_error_code(std::errc::permission_denied));
  return text;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Calls `section` with the name of each section and `entry` with each key and its value. Comments begin with ';' or
/// '#'.
template <class Section, class Entry>
void read_lines(std::string_view text, Section&& section, Entry&& entry) {
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == ';' || line.front() == '#') continue;
    const auto fault = [&](const char* why) { return PluginError("line " + std::to_string(number) + ": " + why); };
    if (line.front() == '[') {
      if (line.back() != ']') throw fault("unmatched '['");
      section(trimmed(line.substr(1, line.size() - 2)));
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) throw fault("'=' character not found in line");
    if (!entry(std::string(trimmed(line.substr(0, equals))), trimmed(line.substr(equals + 1))))
      throw fault("duplicate key name");
  }
}

bool is_entry(std::string_view symbol) {
  constexpr std::string_view prefix = "withy_plugin_";
  if (!symbol.starts_with(prefix)) return false;
  symbol.remove_prefix(prefix.size());
  return !symbol.empty() && symbol.size() <= 64 && std::all_of(symbol.begin(), symbol.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

Manifest parse(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  Manifest manifest;
  std::string provides;
  const std::array<std::pair<std::string_view, std::string*>, 4> keys = {{{"library", &manifest.library},
                                                                          {"entry", &manifest.entry},
                                                                          {"provides", &provides},
                                                                          {"version", &manifest.version}}};
  std::map<std::string, std::string> values;
  int sections = 0;
  bool apart = false;
  read_lines(
      text,
      [&](std::string_view name) {
        ++sections;
        apart = apart || name != "withy-plugin";
      },
      [&](std::string key, std::string_view value) {
        apart = apart || sections == 0;
        return values.emplace(std::move(key), value).second;
      });
  if (apart || sections != 1) throw PluginError("it does not consist of one section [withy-plugin]");
  for (const auto& [key, value] : values) {
    const auto it = std::find_if(keys.begin(), keys.end(), [&k = key](const auto& known) { return known.first == k; });
    if (it == keys.end()) throw PluginError("the key '" + key + "' is unknown");
    *it->second = value;
  }
  for (const auto& [key, value] : keys) {
    if (value->empty()) throw PluginError("the key '" + std::string(key) + "' is missing or empty");
  }
  if (const std::filesystem::path library = manifest.library;
      library.has_parent_path() || library == "." || library == "..") {
    throw PluginError("'" + manifest.library + "' under library is not the plain name of a file");
  }
  if (!is_entry(manifest.entry)) {
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
  } catch (const PluginError& e) {
    throw refuse(e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    throw PluginError("the manifest " + file.string() + " cannot be read: " + e.code().message());
  }
}

}  // namespace withy
