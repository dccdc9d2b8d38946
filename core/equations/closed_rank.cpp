/// \file
/// How many of the closing equations are independent, at a state and from one to the next.
#include <algorithm>
#include <cmath>

#include "withy/core/equations/closed_equations.hpp"

namespace withy::equations {
namespace {

/// Whether a symmetric matrix, n × n row-major, of which the lower triangle counts, is positive. Destroys it.
bool positive(double* A, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    if (!(A[k * n + k] > 0)) return false;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = A[i * n + k] / A[k * n + k];
      for (std::size_t j = k + 1; j <= i; ++j) A[i * n + j] -= f * A[j * n + k];
    }
  }
  return true;
}

}  // namespace

bool ClosedEquations::keeps_rank(std::span<const double> before, std::span<const double> after, const LoopRank& rank,
                                 Work& work) const noexcept {
  find_rows(after, J_after_.in(work), work);
  if (!factorize(before, work).ok()) return false;
  return (keeps_rank_by_mass(rank.independent, work) || keeps_rank_by_columns(rank.independent, work)) &&
         distinct_rows(rank.sizes, work) >= rank.distinct;
}

LoopRank ClosedEquations::rank_at(std::span<const double> y, Work& work) const {
  LoopRank rank;
  for (const LoopCount& count : counts(y, work)) rank.independent += count.independent;
  const std::span<const double> J = J_.in(work);
  for (std::size_t i = 0; i < rows_; ++i)
    rank.sizes.push_back(std::sqrt(row_product(&J[i * speeds_], &J[i * speeds_], speeds_)));
  // A row that is rounding of nothing, as of a plane loop whose plane stands askew, has no size to be measured by.
  constexpr double nothing = 1e-12;
  const double greatest = rank.sizes.empty() ? 0.0 : *std::max_element(rank.sizes.begin(), rank.sizes.end());
  for (double& size : rank.sizes)
    if (!(size > nothing * greatest)) size = 0;
  rank.distinct = distinct_rows(rank.sizes, work);
  return rank;
}

std::size_t ClosedEquations::distinct_rows(std::span<const double> sizes, Work& work) const noexcept {
  constexpr double told_apart = 1e-6;  // the root of a gap that is closed
  const std::span<const double> J = J_.in(work), Z = Z_.in(work);
  const std::span<double> A = A_.in(work), moved = slopes_.in(work).first(speeds_);  // what a motion drives is not
  std::fill(moved.begin(), moved.end(), 0.0);
  for (std::size_t k = 0; k < rows_ * speeds_; ++k)
    if (Z[k] != 0) moved[k % speeds_] = 1;
  for (std::size_t i = 0; i < rows_; ++i)
    for (std::size_t j = 0; j < rows_; ++j) {
      double sum = 0;
      for (std::size_t c = 0; c < speeds_; ++c) sum += moved[c] * J[i * speeds_ + c] * J[j * speeds_ + c];
      A[i * rows_ + j] = sizes[i] > 0 && sizes[j] > 0 ? sum / (sizes[i] * sizes[j]) : 0;
    }
  PivotedFactors f = factors(work);
  f.factorize(A.data(), PivotedFactors::independent);
  std::size_t distinct = 0;
  for (std::size_t k = 0; k < f.rank; ++k) distinct += f.L[k * rows_ + k] > told_apart ? 1 : 0;
  return distinct;
}

/// In the place of M⁻¹, which a direction with next to no inertia outweighs, one over the squares of J₁'s columns. What
/// carries a loop has columns as small as the gap, or as rounding, which beside their own size would count for rank.
bool ClosedEquations::keeps_rank_by_columns(std::size_t rank, Work& work) const noexcept {
  const std::span<const double> now = J_.in(work), later = J_after_.in(work), Z = Z_.in(work);
  const std::span<double> weights = slopes_.in(work).first(speeds_), A = A_.in(work), B = other_A_.in(work);
  for (std::size_t c = 0; c < speeds_; ++c) {
    double square = 0, moved = 0;  // what a motion drives is not moved
    for (std::size_t i = 0; i < rows_; ++i) {
      square += now[i * speeds_ + c] * now[i * speeds_ + c];
      moved = std::max(moved, std::abs(Z[i * speeds_ + c]));
    }
    weights[c] = in_loops_[c] && moved > 0 && square > 0 ? 1 / square : 0;
  }
  const auto weighed = [&](std::span<const double> rows, std::size_t i, std::size_t j) {
    double sum = 0;
    for (std::size_t c = 0; c < speeds_; ++c) sum += now[i * speeds_ + c] * weights[c] * rows[j * speeds_ + c];
    return sum;
  };
  for (std::size_t i = 0; i < rows_; ++i)
    for (std::size_t j = 0; j < rows_; ++j) A[i * rows_ + j] = weighed(now, i, j);
  PivotedFactors f = factors(work);
  f.factorize(A.data(), PivotedFactors::independent);
  if (f.rank < rank) return false;
  const std::size_t r = f.rank;
  for (std::size_t i = 0; i < r; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      B[i * r + j] = 0.5 * (weighed(later, f.order[i], f.order[j]) + weighed(later, f.order[j], f.order[i]));
  return positive(B.data(), r);
}

bool ClosedEquations::keeps_rank_by_mass(std::size_t rank, Work& work) const noexcept {
  const std::span<double> later = J_after_.in(work), B = other_A_.in(work);
  const PivotedFactors f = factors(work);
  if (f.rank < rank) return false;
  const std::span<const double> Z = Z_.in(work);
  const std::size_t r = f.rank;
  const auto L = [&f](std::size_t i, std::size_t k) { return f.L[i * f.size + k]; };
  for (std::size_t i = 0; i < r; ++i)
    for (std::size_t j = 0; j < r; ++j)
      B[i * r + j] = row_product(&Z[f.order[i] * speeds_], &later[f.order[j] * speeds_], speeds_);
  for (std::size_t i = 0; i < r; ++i)
    for (std::size_t j = 0; j < r; ++j) {
      for (std::size_t k = 0; k < i; ++k) B[i * r + j] -= L(i, k) * B[k * r + j];
      B[i * r + j] /= L(i, i);
    }
  for (std::size_t i = 0; i < r; ++i)
    for (std::size_t j = 0; j < r; ++j) {
      for (std::size_t k = 0; k < j; ++k) B[i * r + j] -= B[i * r + k] * L(j, k);
      B[i * r + j] /= L(j, j);
    }
  for (std::size_t i = 0; i < r; ++i)
    for (std::size_t j = 0; j < i; ++j) B[i * r + j] = 0.5 * (B[i * r + j] + B[j * r + i]);
  return positive(B.data(), r);
}

std::vector<LoopCount> ClosedEquations::counts(std::span<const double> y, Work& work) const {
  static_cast<void>(factorize(y, work));
  const std::span<const double> A = A_.in(work);
  std::vector<LoopCount> all;
  std::size_t rows = 0, before = 0;
  for (const LoopClosure* c : loops_of(*model_)) {
    rows += c->equations().size();
    const std::span<double> part = other_A_.in(work);
    for (std::size_t i = 0; i < rows; ++i) std::copy_n(&A[i * rows_], rows, &part[i * rows]);
    PivotedFactors f = factors(work);
    f.size = rows;
    f.factorize(part.data(), PivotedFactors::independent);
    all.push_back({c->name(), c->equations().size(), f.rank - before});
    before = f.rank;
  }
  return all;
}

}  // namespace withy::equations
