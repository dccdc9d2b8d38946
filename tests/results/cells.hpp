/// \file
/// Cells of tables with commas.
#pragma once

#include <string>
#include <vector>

namespace withy::test {

/// The cells of a line; quotes are characters as others are.
inline std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all(1);
  for (const char c : line) {
    if (c == ',')
      all.emplace_back();
    else
      all.back() += c;
  }
  return all;
}

}  // namespace withy::test
