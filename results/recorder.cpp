#include "withy/results/recorder.hpp"

#include <algorithm>
#include <stdexcept>

namespace withy {

std::vector<double> MemoryRecorder::column(const std::string& name) const {
  const auto at = std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
  if (at == columns_.end()) throw std::out_of_range("no column '" + name + "'");
  const auto index = static_cast<std::size_t>(at - columns_.begin());
  std::vector<double> numbers;
  numbers.reserve(rows_.size());
  for (const std::vector<double>& row : rows_) numbers.push_back(row[index]);
  return numbers;
}

}  // namespace withy
