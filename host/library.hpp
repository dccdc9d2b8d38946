/// \file
/// What a program that embeds withy makes first: the plugins, and where remarks go.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace withy {
class Registry;
}

namespace withy::host {

/// A number that goes in or comes out: its name in the scene, and its SI unit (empty for modal coordinates).
struct Port {
  std::string name;
  std::string unit;
};

struct LibraryOptions {
  std::vector<std::filesystem::path> plugins;  ///< folders of plugins beside the package's own
  /// Takes remarks, a sentence each: plugins that were refused, what a completed run should not keep to itself. Called
  /// by the thread that causes the remark; must not throw. Empty: nobody hears them.
  std::function<void(std::string_view)> log;
};

/// The plugins of a program. Copies are the same library; threads share it. Nothing made with it prints, exits, or
/// changes locale, signals, working folder or floating-point control of the process.
class Library {
 public:
  explicit Library(LibraryOptions options = {});
  /// For the functions of `withy::study` and `withy::scene`; lives as long as any copy of the library.
  [[nodiscard]] Registry& registry() const;
  void log(std::string_view remark) const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;
};

}  // namespace withy::host
