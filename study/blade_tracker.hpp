/// \file
/// Modes of equal blades along a sweep, seen from where the rotor does not turn: which one continues which.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "withy/study/turning.hpp"

namespace withy::study {

/// Follows the modes of equal blades through a sweep: a branch keeps its number although others cross it.
class BladeTracker {
 public:
  /// Sets `found.branches`, by likeness of shape and by closeness to where the last two values of each branch lead to;
  /// at the second value of a branch, to where its exponent is seen by what turns if that stays: a pattern that runs
  /// forward gains the rotor's rate. A branch whose frequency passes through zero goes on as the conjugate of what is
  /// found: backward becomes forward. Where a pair becomes two real exponents a branch begins; where two become a pair
  /// one ends; so does one that nothing is like. Where shapes have another number of components all end, and others
  /// begin. \param value of what is swept; values need not be equally spaced
  void follow(double value, BladeModes& found);

 private:
  struct Branch {
    std::size_t number = 0;
    double value = 0;               ///< at which it was met last
    std::complex<double> exponent;  ///< there [1/s]; imaginary part below zero once it has passed zero
    Eigen::VectorXcd shape;
    double waves = 0, rate = 0;                 ///< as in BladeModes; waves of the conjugate have the other sign
    std::optional<std::complex<double>> slope;  ///< of the exponent, over the value; none of one that has just begun
  };

  std::vector<Branch> last_;
  std::size_t next_ = 0;  ///< number of the next branch that begins
};

}  // namespace withy::study
