#include "withy/results/csv.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace withy {

std::string csv_line(std::span<const double> numbers) {
  constexpr std::size_t longest = 26;  // "-1.2345678901234567e-308" and what separates it
  std::string line(numbers.size() * longest + 1, '\0');
  char* end = line.data();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) *end++ = ',';
    if (std::isfinite(numbers[i])) end = fmt::format_to(end, FMT_COMPILE("{}"), numbers[i]);
  }
  *end++ = '\n';
  line.resize(static_cast<std::size_t>(end - line.data()));
  return line;
}

std::string column_name(const std::string& column) {
  std::string name;
  for (const char c : column) {
    if (c == '[')
      name += '.';
    else if (c == ',')
      name += ';';
    else if (c != ']' && !(c == ' ' && name.ends_with(';')))
      name += c;
  }
  return name;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string csv_head(const std::vector<Column>& columns) {
  std::string line;
  for (const Column& c : columns) {
    if (!line.empty()) line += ',';
    line += column_name(c.name) + '[' + (c.unit.empty() ? "1" : c.unit) + ']';
  }
  return line + '\n';
}

std::vector<Column> read_csv_head(std::string_view line) {
  std::vector<Column> columns;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    const std::string_view text = line.substr(at, end - at);
    const std::size_t bracket = text.rfind('[');
    if (bracket == std::string_view::npos || text.back() != ']')
      throw std::invalid_argument("expected name[unit], got '" + std::string(text) + "'");
    columns.push_back(
        {std::string(text.substr(0, bracket)), std::string(text.substr(bracket + 1, text.size() - bracket - 2))});
    at = end + 1;
  }
  return columns;
}

void read_csv_line(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  const char* at = line.data();
  const char* end = at + line.size();
  for (bool more = true; more;) {
    double number = std::numeric_limits<double>::quiet_NaN();
    const auto [stop, error] = std::from_chars(at, end, number);
    const bool nothing = stop == at;
    if ((!nothing && error != std::errc()) || (stop != end && *stop != ','))
      throw std::invalid_argument("expected numbers with commas between them");
    numbers.push_back(number);
    more = stop != end;
    at = stop + 1;
  }
}

}  // namespace withy
