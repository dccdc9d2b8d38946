/// \file
/// Distributions of a varied value.
#pragma once

#include <optional>
#include <string>

namespace withy::campaign {

/// What a random number of the unit interval becomes. Values are in SI units.
struct Distribution {
  enum class Kind { uniform, normal, lognormal };
  Kind kind = Kind::uniform;
  double mean = 0, deviation = 1;  ///< of the value itself, of a lognormal one too, before it is cut off
  std::optional<double> from, to;  ///< ends of a uniform one; where the others are cut off

  /// The value that a share u of all, strictly between 0 and 1, lies below.
  [[nodiscard]] double quantile(double u) const;
  /// What is wrong with the numbers; empty where they make a distribution.
  [[nodiscard]] std::string problem() const;
};

/// The standard normal value that a share u lies below, and the share below a value.
double normal_quantile(double u);
double normal_share(double z);

}  // namespace withy::campaign
