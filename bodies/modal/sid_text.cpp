#include "sid_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

#include "sid.hpp"

namespace withy::sid {

FormatError::FormatError(int line, const std::string& message)
    : std::runtime_error(line > 0 ? fmt::format("line {}: {}", line, message) : message) {}

std::string_view trimmed(std::string_view s) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t from = s.find_first_not_of(blank);
  if (from == std::string_view::npos) return {};
  return s.substr(from, s.find_last_not_of(blank) - from + 1);
}

std::string_view Lines::raw() {
  ++number_;
  const std::size_t end = rest_.find('\n');
  const std::string_view line = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
  return trimmed(line);
}

Line Lines::next(std::string_view expected) {
  while (!rest_.empty()) {
    const std::string_view s = raw();
    if (s.empty()) continue;
    const std::size_t equals = s.find('=');
    if (equals == std::string_view::npos) return {number_, s, {}, false};
    return {number_, trimmed(s.substr(0, equals)), trimmed(s.substr(equals + 1)), true};
  }
  throw FormatError(number_, fmt::format("the file ends; need '{}'", expected));
}

double number(const Line& line) {
  std::string text(line.value);
  for (char& c : text) {
    if (c == 'D' || c == 'd') c = 'E';  // Fortran's double precision
  }
  const char* from = text.data() + (text.starts_with('+') ? 1 : 0);
  double x = 0;
  const auto [end, error] = std::from_chars(from, text.data() + text.size(), x);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(x)) {
    throw FormatError(line.number, fmt::format("got '{} = {}'; need a finite number", line.key, line.value));
  }
  return x;
}

int whole(const Line& line, int least, int most) {
  const double x = number(line);
  if (x != std::floor(x) || x < least || x > most) {
    throw FormatError(line.number, fmt::format("got '{} = {}'; need a whole number from {} to {}", line.key, line.value,
                                               least, most));
  }
  return static_cast<int>(x);
}

std::optional<std::pair<int, std::array<int, 3>>> element(std::string_view key) {
  if (key.size() < 5 || (key[0] != 'm' && key[0] != 'M') || (key[1] != '0' && key[1] != '1')) return {};
  const int order = key[1] - '0';
  key = trimmed(key.substr(2));
  if (!key.starts_with('(') || !key.ends_with(')')) return {};
  key = key.substr(1, key.size() - 2);
  std::array<int, 3> at{};
  const std::size_t count = order == 0 ? 2 : 3;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t comma = key.find(',');
    if ((comma == std::string_view::npos) != (k + 1 == count)) return {};
    const std::string_view index = trimmed(key.substr(0, comma));
    const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), at[k]);
    if (error != std::errc{} || end != index.data() + index.size()) return {};
    key = comma == std::string_view::npos ? std::string_view{} : key.substr(comma + 1);
  }
  return std::pair{order, at};
}

}  // namespace withy::sid
