/// \file
/// Factors of a small symmetric matrix that may be singular: which of its rows are independent, and solutions in those.
#pragma once

#include <cstddef>

namespace withy::equations {

/// Σ a_i b_i of two rows of n numbers.
inline double row_product(const double* a, const double* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// Cholesky factors of A with A_ii ≥ 0, rows in the order of what is left of them: at each step the greatest comes next
/// of those which the ones before explain least, as a share of themselves (to a factor of two). A row that is next to
/// nothing, as where a crank stands across, would pass its rounding on to all that depend on it. All arrays are the
/// caller's.
struct PivotedFactors {
  std::size_t size = 0;          ///< m
  double* L = nullptr;           ///< m × m row-major; row k belongs to row order[k] of A
  std::size_t* order = nullptr;  ///< m
  double* left = nullptr;        ///< m numbers of scratch space
  std::size_t rank = 0;

  /// Share of itself that a row keeps beside the others where it is taken for independent of them.
  static constexpr double independent = 1e-10;

  /// Factorizes A, m × m row-major, which stays. \param least share by which a row is independent
  void factorize(const double* A, double least) noexcept;
  /// x with A x = b in the independent rows, zero in the others; b and x may be one.
  void solve(const double* b, double* x) noexcept;
};

}  // namespace withy::equations
