#include "withy/results/report/decimated_table.hpp"

#include <algorithm>

namespace withy {

/// By what comes after it. What is no number is passed over.
void DecimatedTable::widen(Range& range, const Range& next) {
  if (!(range.low <= range.high)) {
    range = next;
    return;
  }
  const bool lower = next.low<range.low, higher = next.high> range.high;
  if (lower && higher) {
    range = next;
  } else if (lower) {
    range = {next.low, range.high, true};
  } else if (higher) {
    range = {range.low, next.high, false};
  }
}

DecimatedTable::DecimatedTable(std::size_t stretches, std::size_t samples, std::size_t numbers)
    : most_stretches_(stretches / 2 * 2), most_samples_(samples), most_numbers_(numbers) {}

void DecimatedTable::begin(const std::vector<Column>& columns) {
  constexpr std::size_t least = 200;
  columns_ = columns;
  if (most_numbers_ == 0 || columns.empty() || most_stretches_ <= least) return;
  most_stretches_ = std::clamp(most_numbers_ / columns.size() / 2 * 2, least, most_stretches_);
}

void DecimatedTable::row(std::span<const double> numbers) {
  const std::size_t n = columns_.size();
  if (rows_ % stride_ == 0) {
    if (ranges_.size() == most_stretches_ * n) halve();
  }
  if (rows_ % stride_ == 0) {
    for (const double x : numbers) ranges_.push_back({x, x, false});
  } else {
    Range* range = ranges_.data() + ranges_.size() - n;
    for (const double x : numbers) widen(*range++, {x, x, false});
  }
  last_.assign(numbers.begin(), numbers.end());
  if (rows_ % sample_stride_ == 0) {
    samples_.push_back(last_);
    if (samples_.size() > most_samples_) {
      for (std::size_t i = 1; 2 * i < samples_.size(); ++i) samples_[i] = std::move(samples_[2 * i]);
      samples_.resize((samples_.size() + 1) / 2);
      sample_stride_ *= 2;
    }
  }
  ++rows_;
}

/// Two stretches become one.
void DecimatedTable::halve() {
  const std::size_t n = columns_.size(), count = ranges_.size() / n;
  for (std::size_t s = 0; 2 * s < count; ++s) {
    for (std::size_t c = 0; c < n; ++c) {
      Range merged = ranges_[2 * s * n + c];
      if (2 * s + 1 < count) widen(merged, ranges_[(2 * s + 1) * n + c]);
      ranges_[s * n + c] = merged;
    }
  }
  ranges_.resize((count + 1) / 2 * n);
  stride_ *= 2;
}

std::vector<double> DecimatedTable::column(std::size_t index) const {
  const std::size_t n = columns_.size();
  std::vector<double> numbers;
  for (std::size_t at = index; at < ranges_.size(); at += n) {
    const Range& r = ranges_[at];
    numbers.push_back(r.falls ? r.high : r.low);
    if (stride_ > 1) numbers.push_back(r.falls ? r.low : r.high);
  }
  return numbers;
}

std::vector<std::vector<double>> DecimatedTable::samples() const {
  std::vector<std::vector<double>> all = samples_;
  if (rows_ > 0 && (rows_ - 1) % sample_stride_ != 0) all.push_back(last_);
  return all;
}

}  // namespace withy
