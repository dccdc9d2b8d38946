/// \file
/// What a scene is made from beside its own text: files and plugins.
#pragma once

#include <string>
#include <vector>

namespace withy {

/// A file that a scene names.
struct FileUsed {
  std::string path;  ///< as the scene has it
  std::string sha256;
};

/// A plugin that a scene names, or has by default.
struct PluginUsed {
  std::string kind, id;
  std::string file;  ///< its library; "built in" where there is none
};

/// Each once, sorted.
struct SceneSources {
  std::vector<FileUsed> files;
  std::vector<PluginUsed> plugins;

  void add(FileUsed file);
  void add(PluginUsed plugin);
};

}  // namespace withy
