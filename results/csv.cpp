#include "withy/results/csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace withy {

std::string csv_line(const std::vector<double>& numbers) {
  std::string line;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) line += ',';
    if (std::isfinite(numbers[i])) fmt::format_to(std::back_inserter(line), "{}", numbers[i]);
  }
  return line + '\n';
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
