/// \file
/// A property of a beam's section along the beam: constant, or linear between the rows of a table.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy {

class Profile {
 public:
  explicit Profile(double constant) : rows_{{0, constant}} {}
  /// Value at x [m].
  [[nodiscard]] double operator()(double x) const;
  /// Mean over [0, length].
  [[nodiscard]] double mean() const;
  /// Abscissae of the table's rows, where the property may have a kink; none where it is constant.
  [[nodiscard]] std::vector<double> knots() const;

  /// From a checked number or table of (x, property); nothing after reporting a table that does not go from the root to
  /// the tip, x = length.
  static std::optional<Profile> read(const Value& value, double length, Diagnostics& diagnostics);

 private:
  explicit Profile(std::vector<std::pair<double, double>> rows) : rows_(std::move(rows)) {}
  std::vector<std::pair<double, double>> rows_;
};

}  // namespace withy
