#include "withy/program/colour.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace withy::program {
namespace {

constexpr const char *green = "\033[32m", *red = "\033[31m", *bold = "\033[1m", *plain = "\033[0m";

/// Null where the word is no outcome.
const char* colour_of(std::string_view word) {
  if (word == "completed") return green;
  constexpr std::string_view bad[] = {"diverged",    "singular", "step-underflow", "inaccurate",
                                      "interrupted", "refused",  "load-failed",    "too-stiff"};
  return std::find(std::begin(bad), std::end(bad), word) != std::end(bad) ? red : nullptr;
}

/// "scene.yaml:3:7:" or "table.csv:3:"
bool is_place(std::string_view word) {
  if (!word.ends_with(':')) return false;
  word.remove_suffix(1);
  const std::size_t colon = word.find_last_of(':');
  return colon != std::string_view::npos && colon > 0 && colon + 1 < word.size() &&
         word.find_first_not_of("0123456789", colon + 1) == std::string_view::npos;
}

}  // namespace

bool shows_colours(int stream) noexcept {
  const char *never = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return (never == nullptr || *never == '\0') && terminal != nullptr && std::strcmp(terminal, "dumb") != 0 &&
         ::isatty(stream) == 1;
}

std::string with_outcomes_coloured(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    const std::string_view word = text.substr(0, end);
    const char* colour = colour_of(word);
    if (colour != nullptr) out += colour;
    out += word;
    if (colour != nullptr) out += plain;
    if (end < text.size()) out += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string with_places_bold(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end), head = line.substr(0, line.find(' '));
    if (is_place(head))
      out += std::string(bold).append(head).append(plain).append(line.substr(head.size()));
    else
      out += line;
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace withy::program
