/// \file
/// The test set of T. E. Hull, W. H. Enright, B. M. Fellen and A. E. Sedgwick, "Comparing numerical methods for
/// ordinary differential equations", SIAM J. Numer. Anal. 9 (1972) 603–637: classes A to E, 0 ≤ t ≤ 20.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withy/tests/conformance/function_equations.hpp"

namespace withy::extremes {

struct DetestProblem {
  std::string name;  ///< "A1" … "E5"
  std::vector<double> start;
  std::size_t speeds = 0;  ///< of a system of second order: the last half of the numbers, rates of the first half
  std::function<void(double t, const double* y, double* f)> slope;
  /// The same in more digits, for references.
  std::function<void(long double t, const long double* y, long double* f)> fine;

  [[nodiscard]] FunctionEquations equations() const;
  [[nodiscard]] State state() const;
  static constexpr double end = 20;
};

/// All 25.
std::vector<DetestProblem> detest_problems();

/// y at `parts` equal intervals of 0 … 20, by extrapolation of the modified midpoint rule to order 16 (Gragg, Bulirsch
/// & Stoer) in numbers of 64 bits of mantissa, with `steps` equal steps.
std::vector<std::vector<double>> detest_reference(const DetestProblem& problem, int parts, int steps);

}  // namespace withy::extremes
