/// \file
/// What the tests of plugin loading share.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/plugins/host/plugin_host.hpp"

namespace zoo_keeper {

namespace fs = std::filesystem;

/// Directory of a case of the zoo.
inline fs::path place(const std::string& name) { return fs::path(WITHY_ZOO) / name; }

/// A directory that is removed at the end, for arrangements of a test's own.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::temp_directory_path() / "withy-zoo-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = fs::canonical(pattern);
  }
  ~Scratch() { fs::remove_all(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }
  /// Writes a file; its path.
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }
  /// A copy of a case of the zoo in a directory `name` below.
  fs::path house(const std::string& zoo_case, const std::string& name) const {
    fs::copy(place(zoo_case), path_ / name);
    return path_ / name;
  }

 private:
  fs::path path_;
};

/// What the registry says when it is asked for a body: the error's text, or "loaded", or "unknown".
inline std::string ask(withy::Registry& registry, const std::string& id) {
  try {
    return registry.find<withy::Body>(id) != nullptr ? "loaded" : "unknown";
  } catch (const withy::PluginError& e) {
    return e.what();
  }
}

/// The same of a fresh host of these directories.
inline std::string ask(const std::vector<fs::path>& directories, const std::string& id) {
  withy::Registry registry;
  const withy::PluginHost host(directories);
  host.attach(registry);
  return ask(registry, id);
}

/// Whether a file is mapped into this process.
inline bool is_mapped(const fs::path& file) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    if (line.ends_with(file.string())) return true;
  }
  return false;
}

}  // namespace zoo_keeper
