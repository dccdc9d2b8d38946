#include "withy/results/recorder.hpp"

#include <algorithm>
#include <stdexcept>

namespace withy {

void SharedRecorder::begin(const std::vector<Column>& columns) {
  for (Recorder* r : recorders_) r->begin(columns);
}

void SharedRecorder::row(std::span<const double> numbers) {
  for (Recorder* r : recorders_) r->row(numbers);
}

RecordMark SharedRecorder::mark() {
  const RecordMark first = recorders_.front()->mark();
  for (std::size_t i = 1; i < recorders_.size(); ++i) static_cast<void>(recorders_[i]->mark());
  return first;
}

void SharedRecorder::end() {
  for (Recorder* r : recorders_) r->end();
}

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
