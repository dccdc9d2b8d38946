#include "withy/results/csv.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>

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

std::string csv_head(const std::vector<Column>& columns) {
  std::string line;
  for (const Column& c : columns) {
    if (!line.empty()) line += ',';
    line += c.unit.empty() ? c.name : c.name + '[' + c.unit + ']';
  }
  return line + '\n';
}

}  // namespace withy
