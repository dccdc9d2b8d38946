/// \file
/// The values of a scene that a command goes through: `--over path=value,value,…`, `--sweep path=from:to:count`.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace withy::app {

struct Variation {
  std::string path;
  std::vector<std::string> values;
  [[nodiscard]] bool none() const { return path.empty(); }
  /// Last part of the path: "time_scale".
  [[nodiscard]] std::string label() const { return path.substr(path.find_last_of('.') + 1); }
};

/// An empty text gives no variation with one empty value. \throws InputError
Variation parse_variation(const std::string& text);

/// Numbers from the first to the last, evenly.
struct Sweep {
  std::string path;
  std::vector<double> values;
  [[nodiscard]] bool none() const { return path.empty(); }
  /// The hinge of `spin.hinge`; empty for a path of the scene.
  [[nodiscard]] std::string spun() const { return path.starts_with("spin.") ? path.substr(5) : ""; }
};

/// Reads `path=from:to:count`, or `path=from:to` where a count is given here. An empty text gives no sweep with the one
/// value zero.
/// \param option named in messages, as "--sweep".
/// \throws InputError
Sweep parse_sweep(const std::string& text, const std::string& option, std::optional<std::size_t> count = {});

}  // namespace withy::app
