/// \file
/// Second-order fields of a body's modes, those that are not zero.
#pragma once

#include <vector>

#include "withy/core/spatial/pack.hpp"

namespace withy::sweep {

/// Second-order fields Γ_ij of one component that are not all zero: those of row i and of j in [first, last), j ≥ i.
struct FieldRun {
  int component = 0, row = 0, first = 0, last = 0;
  friend bool operator==(const FieldRun&, const FieldRun&) = default;
};

/// Where Γ_ij stands among those of i ≤ j.
constexpr int pair_at(int i, int j, int n) { return i * n - i * (i - 1) / 2 + j - i; }

/// The runs of n modes' fields. \param fields a column for each component of each pair i ≤ j, components innermost
template <int components, class Matrix>
std::vector<FieldRun> runs_of(const Matrix& fields, int n) {
  std::vector<FieldRun> runs;
  for (int c = 0; c < components; ++c) {
    for (int i = 0; i < n; ++i) {
      FieldRun run{c, i, 0, 0};
      for (int j = i; j < n; ++j) {
        if (fields.col(components * pair_at(i, j, n) + c).isZero(0)) continue;
        if (run.last == 0) run.first = j;
        run.last = j + 1;
      }
      if (run.last > 0) runs.push_back(run);
    }
  }
  return runs;
}

/// Adds fields Γ_ij of a row i and of j in [first, last), j ≥ i, at `g` for j = first and `step` groups further each,
/// of which `width` groups stand together: to those of mode j at P + j·stride what Γq is, to `bend` q̇ᵀΓq̇, of which what
/// stands right of the diagonal counts twice.
template <int width, class Group, class Scalar>
inline void add_run(const Group* g, int step, int i, int first, int last, const Scalar* q, const Scalar* q_dot,
                    Group* P, int stride, Group* bend) {
  const Group qi = spread(q[i]), rate = spread(q_dot[i]), twice = rate + rate;
  Group own[width], right[width];
  for (int c = 0; c < width; ++c) {
    own[c] = P[i * stride + c];
    right[c] = spread(Scalar(0));
  }
  int j = first;
  if (j == i) {
    for (int c = 0; c < width; ++c) {
      own[c] += g[c] * qi;
      bend[c] += g[c] * (rate * rate);
    }
    ++j, g += step;
  }
  for (; j < last; ++j, g += step) {
    const Group qj = spread(q[j]), rate_j = spread(q_dot[j]);
    for (int c = 0; c < width; ++c) {
      own[c] += g[c] * qj;
      P[j * stride + c] += g[c] * qi;
      right[c] += g[c] * rate_j;
    }
  }
  for (int c = 0; c < width; ++c) {
    P[i * stride + c] = own[c];
    bend[c] += right[c] * twice;
  }
}

}  // namespace withy::sweep
