/// \file
/// `--over path=value,value,…`: the values of a scene that a command goes through.
#pragma once

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

}  // namespace withy::app
