#include "withy/results/report/decimated_table.hpp"

#include <algorithm>

namespace withy {

/// By what comes after it. What is no number is passed over.
void DecimatedTable::widen(Range& range, const Range& next) {
  const double low = std::min(range.first, range.second), high = std::max(range.first, range.second);
  if (!(low <= high)) {
    range = next;
    return;
  }
  const double next_low = std::min(next.first, next.second), next_high = std::max(next.first, next.second);
  const bool lower = next_low<low, higher = next_high> high;
  if (lower && higher) {
    range = next;
  } else if (lower) {
    range = {high, next_low};
  } else if (higher) {
    range = {low, next_high};
  }
}

DecimatedTable::DecimatedTable(std::size_t stretches, std::size_t samples, std::size_t numbers)
    : most_stretches_(stretches / 2 * 2), most_samples_(samples), most_numbers_(numbers) {}

DecimatedTable::DecimatedTable(const DecimatedTable& whole, std::size_t columns)
    : most_stretches_(whole.most_stretches_),
      most_samples_(whole.most_samples_),
      most_numbers_(whole.most_numbers_),
      columns_(whole.columns_.begin(), whole.columns_.begin() + static_cast<std::ptrdiff_t>(columns)),
      rows_(whole.rows_),
      stride_(whole.stride_),
      sample_stride_(whole.sample_stride_),
      stretches_(whole.stretches_),
      samples_(whole.samples_),
      last_(whole.last_) {}

void DecimatedTable::begin(const std::vector<Column>& columns) {
  constexpr std::size_t least = 200;
  columns_ = columns;
  if (most_numbers_ == 0 || columns.empty() || most_stretches_ <= least) return;
  most_stretches_ = std::clamp(most_numbers_ / columns.size() / 2 * 2, least, most_stretches_);
}

DecimatedTable::Range DecimatedTable::Stretch::at(std::size_t column) const {
  return row != nullptr ? Range{(*row)[column], (*row)[column]} : ranges[column];
}

/// Two stretches that adjoin become one.
void DecimatedTable::join(Stretch& stretch, const Stretch& next) {
  if (stretch.row != nullptr) {
    stretch.ranges.reserve(stretch.row->size());
    for (const double x : *stretch.row) stretch.ranges.push_back({x, x});
    stretch.row = nullptr;
  }
  for (std::size_t c = 0; c < stretch.ranges.size(); ++c) widen(stretch.ranges[c], next.at(c));
}

void DecimatedTable::row(std::span<const double> numbers) {
  if (rows_ % stride_ == 0 && stretches_.size() == most_stretches_) halve();
  last_ = std::make_shared<const std::vector<double>>(numbers.begin(), numbers.end());
  if (rows_ % stride_ == 0) {
    stretches_.push_back({last_, {}});
  } else {
    join(stretches_.back(), {last_, {}});
  }
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

void DecimatedTable::halve() {
  const std::size_t count = stretches_.size();
  for (std::size_t s = 0; 2 * s < count; ++s) {
    if (2 * s + 1 < count) join(stretches_[2 * s], stretches_[2 * s + 1]);
    if (s > 0) stretches_[s] = std::move(stretches_[2 * s]);
  }
  stretches_.resize((count + 1) / 2);
  stride_ *= 2;
}

std::vector<double> DecimatedTable::column(std::size_t index) const {
  std::vector<double> numbers;
  numbers.reserve(stretches_.size() * (stride_ > 1 ? 2 : 1));
  for (const Stretch& stretch : stretches_) {
    const Range range = stretch.at(index);
    numbers.push_back(range.first);
    if (stride_ > 1) numbers.push_back(range.second);
  }
  return numbers;
}

std::vector<DecimatedTable::Row> DecimatedTable::samples() const {
  std::vector<Row> all = samples_;
  if (rows_ > 0 && (rows_ - 1) % sample_stride_ != 0) all.push_back(last_);
  return all;
}

}  // namespace withy
