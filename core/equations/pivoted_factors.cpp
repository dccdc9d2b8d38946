#include "withy/core/equations/pivoted_factors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace withy::equations {

void PivotedFactors::factorize(const double* A, double least) noexcept {
  // A row smaller than this part of the greatest is none: rounding of what is zero.
  constexpr double nothing = 1e-24;
  const std::size_t m = size;
  double greatest = 0;
  for (std::size_t i = 0; i < m; ++i) {
    order[i] = i;
    left[i] = A[i * m + i];
    greatest = std::max(greatest, left[i]);
  }
  const auto share = [&](std::size_t k) {
    const double own = A[order[k] * m + order[k]];
    return own > nothing * greatest ? left[k] / own : 0.0;
  };
  for (rank = 0; rank < m; ++rank) {
    double most = 0;
    for (std::size_t k = rank; k < m; ++k) most = std::max(most, share(k));
    if (!(most > least)) break;
    std::size_t next = m;
    for (std::size_t k = rank; k < m; ++k)
      if (share(k) > most / 2 && (next == m || left[k] > left[next])) next = k;
    std::swap(order[rank], order[next]);
    std::swap(left[rank], left[next]);
    for (std::size_t j = 0; j < rank; ++j) std::swap(L[rank * m + j], L[next * m + j]);
    const double pivot = std::sqrt(left[rank]);
    L[rank * m + rank] = pivot;
    for (std::size_t k = rank + 1; k < m; ++k) {
      double sum = A[order[k] * m + order[rank]];
      for (std::size_t j = 0; j < rank; ++j) sum -= L[k * m + j] * L[rank * m + j];
      L[k * m + rank] = sum / pivot;
      left[k] -= L[k * m + rank] * L[k * m + rank];
    }
  }
}

void PivotedFactors::solve(const double* b, double* x) noexcept {
  const std::size_t m = size;
  for (std::size_t k = 0; k < rank; ++k) {
    left[k] = b[order[k]];
    for (std::size_t j = 0; j < k; ++j) left[k] -= L[k * m + j] * left[j];
    left[k] /= L[k * m + k];
  }
  std::fill(x, x + m, 0.0);
  for (std::size_t k = rank; k-- > 0;) {
    for (std::size_t j = k + 1; j < rank; ++j) left[k] -= L[j * m + k] * left[j];
    left[k] /= L[k * m + k];
    x[order[k]] = left[k];
  }
}

}  // namespace withy::equations
