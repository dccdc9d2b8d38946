#include "withy/scene/whole_escapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

namespace withy {
namespace {

constexpr std::size_t escape = 6;              // \ud83d
constexpr int shorter = 2 * int{escape} - 10;  // than a pair is \U0001f600

/// The number of an escape \uXXXX at the beginning of a text.
std::optional<unsigned> unit_of(std::string_view text) {
  if (text.size() < escape || !text.starts_with("\\u")) return std::nullopt;
  unsigned unit = 0;
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + escape, unit, 16);
  if (error != std::errc() || end != text.data() + escape) return std::nullopt;
  return unit;
}

/// The character of a surrogate pair at the beginning of a text.
std::optional<unsigned> pair_of(std::string_view text) {
  const auto high = unit_of(text);
  if (!high || *high < 0xD800 || *high > 0xDBFF) return std::nullopt;
  const auto low = unit_of(text.substr(escape));
  if (!low || *low < 0xDC00 || *low > 0xDFFF) return std::nullopt;
  return 0x10000 + ((*high - 0xD800) << 10) + (*low - 0xDC00);
}

/// Whether there is a pair, in a text where backslashes stand before nothing but escapes.
bool has_pairs(std::string_view text) {
  for (std::size_t at = text.find("\\u"); at != std::string_view::npos; at = text.find("\\u", at + 2))
    if (pair_of(text.substr(at))) return true;
  return false;
}

}  // namespace

WholeEscapes::WholeEscapes(std::string_view text) : text_(text) {
  if (!has_pairs(text) || !nlohmann::json::accept(text)) return;
  int line = 1;
  std::size_t begin = 0;  // of the line in own_
  for (std::size_t at = 0; at < text.size();) {
    const auto character = pair_of(text.substr(at));
    if (character) {
      own_ += fmt::format("\\U{:08x}", *character);
      pairs_.push_back({line, static_cast<int>(own_.size() - begin) + 1});
      at += 2 * escape;
      continue;
    }
    const std::size_t count = text[at] == '\\' ? 2 : 1;  // what an escaped backslash stands before is no escape
    own_ += text.substr(at, count);
    if (text[at] == '\n') {
      ++line;
      begin = own_.size();
    }
    at += count;
  }
  text_ = own_;
}

int WholeEscapes::column(int line, int column) const {
  const auto before = [](const Pair& a, const Pair& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  };
  const auto first = std::lower_bound(pairs_.begin(), pairs_.end(), Pair{line, 0}, before);
  const auto behind = std::upper_bound(first, pairs_.end(), Pair{line, column}, before);
  return column + shorter * static_cast<int>(behind - first);
}

}  // namespace withy
