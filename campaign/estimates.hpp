/// \file
/// Estimates from samples, with the intervals they lie in with 95 % confidence.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace withy::campaign {

/// Ends that a sample tells nothing of are infinite: one number alone has no interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// Of a sample of at least one number.
struct Statistics {
  std::size_t count = 0;
  double mean = 0, deviation = 0, least = 0, greatest = 0;
  std::optional<Estimate> mean_interval;  ///< by Student's t; of samples of two or more
  /// Quantiles at 5, 50 and 95 %, with intervals by order statistics, which ask for no distribution; an end that the
  /// sample is too small for is infinite.
  std::vector<Estimate> quantiles;
};
inline constexpr double shares_of_quantiles[] = {0.05, 0.5, 0.95};
Statistics statistics(std::vector<double> sample);

/// The numbers of a sample below which these shares of it lie, between its order statistics. \param sample not empty
std::vector<double> percentiles(std::vector<double> sample, std::span<const double> shares);

/// The share of `hits` among `count`, by Clopper and Pearson.
Estimate share(std::size_t hits, std::size_t count);

/// One sample of a Saltelli design: the result at its first point, at the second, and with each column of the second in
/// the first.
struct SaltelliSample {
  double first, second;
  std::vector<double> mixed;
};
/// Indices of Sobol of a parameter: the share of the variance that it makes alone (Saltelli and others 2010, table 2 b)
/// and with all others (Jansen 1999), with intervals from their linearization.
struct SobolIndex {
  Estimate first, total;
};
std::vector<SobolIndex> sobol_indices(std::span<const SaltelliSample> samples);

/// Mean, mean size and deviation of the elementary effects of a parameter (Morris 1991, Campolongo 2007).
struct MorrisMeasure {
  double mean = 0, deviation = 0;
  Estimate mean_size;
  std::size_t count = 0;
};
MorrisMeasure morris_measure(const std::vector<double>& effects);

}  // namespace withy::campaign
