/// \file
/// Finds plugin libraries and loads those that are asked for.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/registry.hpp"

namespace withy {

/// One plugin that was found, or one file or directory that could not be used, for `withy plugins`.
struct PluginRecord {
  enum class State {
    available,  ///< promised by a manifest, its library not asked for so far
    loaded,
    refused  ///< `reason` says why
  };
  State state = State::available;
  std::string kind;            ///< as "body"; empty where what the file provides is not known
  std::string id;              ///< empty likewise
  std::filesystem::path file;  ///< the library; the manifest or directory where that is as far as it went
  std::string version;         ///< of the library, from its manifest
  std::string summary;         ///< once loaded
  std::string reason;          ///< one sentence naming the file, where refused
};

/// Plugin libraries in a list of directories. Each is described by a manifest `*.plugin` beside it, so that a library
/// is loaded only when one of its plugins is asked for; once loaded it stays for the life of the process.
///
/// Never fatal: what cannot be used is recorded as refused, and only asking for it throws PluginError. Threads may
/// share a host, or have one each: libraries are loaded one at a time in the whole process.
class __attribute__((visibility("default"))) PluginHost {
 public:
  /// Reads the manifests of the directories. Directories that are absent, and files or directories that others can
  /// write to, are refused; so are two manifests that promise the same plugin.
  explicit PluginHost(const std::vector<std::filesystem::path>& directories);

  /// Where the plugins that belong to this library are: `lib/withy/plugins` of the package or the build tree it is in,
  /// whichever program uses it.
  static std::filesystem::path default_directory();

  /// Makes `registry` ask this host for plugins it does not have. A host serves one registry; either may end first.
  void attach(Registry& registry) const;

  /// Everything found so far, sorted by kind and id, with what cannot be told apart from its file first.
  [[nodiscard]] std::vector<PluginRecord> plugins() const;
  /// The version of each library that is found, by its file.
  [[nodiscard]] std::map<std::string, std::string> versions() const;

 private:
  class Catalogue;
  std::shared_ptr<Catalogue> catalogue_;
};

}  // namespace withy
