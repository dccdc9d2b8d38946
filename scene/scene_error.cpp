#include "withy/scene/scene_error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace withy {
namespace {

std::string report(const std::string& file, const std::vector<Diagnostic>& problems,
                   const std::vector<std::string>& origins) {
  std::string text;
  for (const Diagnostic& d : problems) {
    if (!text.empty()) text += '\n';
    const int line = d.place.line;
    if (line < 0 && static_cast<std::size_t>(-line) <= origins.size()) {
      text += origins[static_cast<std::size_t>(-line) - 1];
    } else if (line > 0) {
      text += fmt::format("{}:{}:{}", file, line, d.place.column);
    } else {
      text += file;
    }
    text += ": ";
    if (!d.place.path.empty()) text += d.place.path + ": ";
    text += d.message;
  }
  return text;
}

/// In the order of the file, what operations brought first; each problem once.
std::vector<Diagnostic> sorted(std::vector<Diagnostic> problems) {
  const auto key = [](const Diagnostic& d) { return std::pair(d.place.line, d.place.column); };
  std::stable_sort(problems.begin(), problems.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto same = [&](const Diagnostic& a, const Diagnostic& b) {
    return key(a) == key(b) && a.place.path == b.place.path && a.message == b.message;
  };
  problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
  return problems;
}

}  // namespace

SceneError::SceneError(std::string file, std::vector<Diagnostic> problems, const std::vector<std::string>& origins)
    : std::runtime_error(report(file, sorted(problems), origins)), problems_(sorted(std::move(problems))) {}

}  // namespace withy
