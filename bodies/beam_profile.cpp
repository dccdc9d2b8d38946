#include "beam_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace withy {

double Profile::operator()(double x) const {
  const auto after =
      std::upper_bound(rows_.begin(), rows_.end(), x, [](double at, const auto& row) { return at < row.first; });
  if (after == rows_.begin()) return rows_.front().second;
  if (after == rows_.end()) return rows_.back().second;
  const auto& [x0, y0] = *(after - 1);
  const auto& [x1, y1] = *after;
  return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
}

double Profile::mean() const {
  if (rows_.size() == 1) return rows_.front().second;
  double integral = 0;
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    integral += 0.5 * (rows_[i].first - rows_[i - 1].first) * (rows_[i].second + rows_[i - 1].second);
  }
  return integral / (rows_.back().first - rows_.front().first);
}

std::vector<double> Profile::knots() const {
  std::vector<double> x;
  if (rows_.size() == 1) return x;
  for (const auto& row : rows_) x.push_back(row.first);
  return x;
}

std::optional<Profile> Profile::read(const Value& value, double length, Diagnostics& diagnostics) {
  if (value.kind() == Value::Kind::number) return Profile(value.number());
  std::vector<std::pair<double, double>> rows;
  for (const Value& row : value.items()) rows.emplace_back(row.items()[0].number(), row.items()[1].number());
  // Lengths in other units than metres may differ in the last bits.
  const double rounding = 1e-9 * length;
  const double from = rows.front().first;
  const double to = rows.back().first;
  if (std::abs(from) > rounding || std::abs(to - length) > rounding || rows.size() < 2) {
    diagnostics.error(value.place(),
                      fmt::format("got a table from x = {} to {} m; need one from the root, 0, to the tip, "
                                  "{} m",
                                  from, to, length));
    return {};
  }
  rows.front().first = 0;
  rows.back().first = length;
  return Profile(std::move(rows));
}

}  // namespace withy
