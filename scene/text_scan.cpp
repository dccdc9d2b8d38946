#include "withy/scene/text_scan.hpp"

#include <fmt/format.h>

#include "withy/scene/document.hpp"

namespace withy {
namespace {

// Brackets in comments and strings count as well, so the bounds are far above what any scene within the limits has.
constexpr int most_open_brackets = 1000;
constexpr std::size_t most_marks = 6 * DocumentLimits::values;

/// Length of the well-formed UTF-8 character at the beginning of s (RFC 3629, table 3-7 of Unicode), 0 where there is
/// none or it is a control character other than tab and line ends.
std::size_t character(std::string_view s) {
  const auto byte = [&](std::size_t i) { return i < s.size() ? static_cast<unsigned char>(s[i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned a = byte(0);
  const unsigned b = byte(1);
  if (a < 0x80) return (a >= 0x20 && a != 0x7f) || a == '\t' || a == '\n' || a == '\r' ? 1 : 0;
  if (a >= 0xC2 && a <= 0xDF) return follows(1) ? 2 : 0;
  if (a >= 0xE0 && a <= 0xEF) {
    if ((a == 0xE0 && b < 0xA0) || (a == 0xED && b > 0x9F)) return 0;
    return follows(1) && follows(2) ? 3 : 0;
  }
  if (a >= 0xF0 && a <= 0xF4) {
    if ((a == 0xF0 && b < 0x90) || (a == 0xF4 && b > 0x8F)) return 0;
    return follows(1) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::optional<TextFault> scan_text(std::string_view text) {
  int line = 1;
  std::size_t line_start = 0;
  int open = 0;
  std::size_t marks = 0;
  for (std::size_t i = 0; i < text.size();) {
    const auto fault = [&](std::string message) {
      return TextFault{line, static_cast<int>(i - line_start) + 1, std::move(message)};
    };
    const std::size_t length = character(text.substr(i));
    if (length == 0) {
      return fault(
          fmt::format("byte 0x{:02x} is not UTF-8 text; a scene is YAML or JSON", static_cast<unsigned char>(text[i])));
    }
    switch (text[i]) {
      case '\n':
        ++line;
        line_start = i + 1;
        break;
      case '[':
      case '{':
        ++open;
        ++marks;
        break;
      case ']':
      case '}':
        if (open > 0) --open;
        ++marks;
        break;
      case ',':
      case ':':
      case '?':
      case '&':
      case '*':
      case '!':
      case '"':
      case '\'':
        ++marks;
        break;
      default:
        break;
    }
    if (open > most_open_brackets) return fault(fmt::format("nested deeper than {} levels", DocumentLimits::depth));
    if (marks > most_marks) return fault(fmt::format("more than {} values", DocumentLimits::values));
    i += length;
  }
  return {};
}

}  // namespace withy
