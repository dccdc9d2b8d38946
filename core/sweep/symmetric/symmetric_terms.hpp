/// \file
/// Work memory of the symmetric sweep, and what enters equation (3) of symmetric_kernel.hpp: stations, sections, moving
/// roots, and the factors of a modal block.
#pragma once

#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy::sweep {

/// Work of a station: written outward, completed inward. Long chains are limited by the memory that goes through the
/// caches, so what is read no more gives its place to what is written later, here and in NodeWork.
template <class Space>
struct StationWork {
  typename Space::Twist V;  ///< twist of S; in a solve, the force that gathers on its way inward
  typename Space::Twist p;  ///< velocity wrench of what it carries
  typename Space::Twist A;  ///< σ_S of (2), until the last pass makes it the acceleration of S
};

/// Elimination of the rates of a hinge with several: Δ, L of Hᵀ I H, and Y = L⁻¹ Hᵀ I, y = L⁻¹ (τ − Hᵀ p).
template <class Space>
struct JointElimination {
  static constexpr int most = Space::dim;
  typename Space::Twist H[most], Y[most];
  typename Space::Scalar L[most * most], y[most];
};

/// Work of a node whose modes move its root station.
template <class Space>
struct RootWork {
  typename Space::Frame frame;  ///< M in the node's frame
  typename Space::Twist sigma;  ///< σ of the root station
};

/// What a node with a driven hinge asks of the hinge: F = I A + p.
template <class Space>
struct DrivenWork {
  typename Space::Inertia I;
  typename Space::Twist p;
};

/// What the mass of a rod gives to I and p of (3); what it gives to C, G, h stands in the node's memory for these until
/// its modes are eliminated. Found as soon as the rod has moved, so that all rods share the memory of their sections.
template <class Space>
struct RodMass {
  typename Space::Inertia I;
  typename Space::Twist p;
};

/// Work of a node; see StationWork.
template <class Space>
struct NodeWork {
  typename Space::Frame SM;        ///< of JointMotion
  typename Space::Twist V;         ///< twist of the node's frame; in a solve, the force that gathers
  typename Space::Twist A;         ///< σ of (1), until the last pass makes it the acceleration of the node's frame
  typename Space::Twist p_or_U;    ///< velocity wrench; from the inward pass on, of one rate, its column of inertia
  typename Space::Scalar inverse;  ///< one rate: 1 / its articulated inertia
  typename Space::Scalar u;        ///< one rate: effort left
};

/// The arrays of one evaluation.
template <class Space>
struct SymmetricState {
  using Scalar = typename Space::Scalar;
  const Scalar* positions;
  const Scalar* speeds;
  const Scalar* efforts;
  Scalar* result;
  std::byte* work;
  const SymmetricNode<Space>* nodes;
  const typename Space::Twist* world;
  double delta = 0;  ///< above 0: G + δ D + δ² K in the place of G
  /// Receives all efforts on driven rates, whose accelerations `result` holds; null: they do not accelerate.
  Scalar* driven = nullptr;
};

/// The quantities of what a node hangs on – a node's frame or a station – in the parent's work memory.
template <class Space>
struct Outer {
  typename Space::Twist *V, *A, *p;

  Outer(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
    const SymmetricNode<Space>& parent = s.nodes[node.parent];
    if (node.parent_station < 0) {
      auto& w = *at<NodeWork<Space>>(s.work, parent.work);
      V = &w.V, A = &w.A, p = &w.p_or_U;
    } else {
      auto& w = at<StationWork<Space>>(s.work, parent.work_stations)[node.parent_station];
      V = &w.V, A = &w.A, p = &w.p;
    }
  }
};

/// Whether the elimination of a node's modes is known before the sweep begins.
template <class Space>
inline bool is_constant(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  return !node.own->factor.empty() && s.delta == 0;
}

/// Factors of the lower triangle of G = L Δ Lᵀ, in place: L below the diagonal, the inverse of Δ on it; whether G is
/// positive definite, of several cases for which. Without square roots, whose latency a small block would feel.
template <int N, class S>
inline auto factorize(S* G, int modes) {
  const int n = count<N>(modes);
  auto good = everywhere<S>();
  for (int j = 0; j < n; ++j) {
    // Row j still holds L Δ to the left of the diagonal; it becomes L here.
    S d = G[j * n + j];
    for (int k = 0; k < j; ++k) {
      const S scaled = G[j * n + k];
      G[j * n + k] = scaled * G[k * n + k];
      d -= scaled * G[j * n + k];
    }
    good = good & positive(d);
    if (none(good)) return good;
    G[j * n + j] = 1 / d;
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) G[i * n + j] -= G[i * n + k] * G[j * n + k];
    }
  }
  return good;
}

/// L⁻¹ b in place, for scalars or twists.
template <int N, class S, class T>
inline void solve_lower(const S* L, int modes, T* b) {
  const int n = count<N>(modes);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= b[k] * L[i * n + k];
  }
}

/// x = L⁻ᵀ Δ⁻¹ (y − Y A): the eliminated unknowns once A is known.
template <int N, class Space>
inline void back_substitute(const typename Space::Scalar* L, const typename Space::Twist* Y,
                            const typename Space::Scalar* y, int modes, const typename Space::Twist& A,
                            typename Space::Scalar* x) {
  const int n = count<N>(modes);
  for (int i = 0; i < n; ++i) x[i] = L[i * n + i] * (y[i] - Space::dot(Y[i], A));
  for (int i = n; i-- > 0;) {
    for (int k = i + 1; k < n; ++k) x[i] -= L[k * n + i] * x[k];
  }
}

/// Adds what a station carries, of articulated inertia IS, to its body: equations (2) into (3).
template <class Space, int N>
inline void collect_station(const StationWork<Space>& sw, const typename Space::Frame& frame,
                            const typename Space::Inertia& IS, const typename Space::Twist* J, int modes,
                            typename Space::Inertia& I, typename Space::Twist& p, typename Space::Twist* C,
                            typename Space::Scalar* G, typename Space::Scalar* h) {
  const int n = count<N>(modes);
  const typename Space::Twist force = sw.p + IS * sw.A;
  I += Space::to_parent(frame, IS);
  p += Space::to_parent(frame, force);
  for (int i = 0; i < n; ++i) {
    const typename Space::Twist IJ = IS * J[i];
    C[i] += Space::to_parent(frame, IJ);
    h[i] += Space::dot(J[i], force);
    for (int j = 0; j <= i; ++j) G[i * n + j] += Space::dot(IJ, J[j]);
  }
}

/// The same for a frozen node, whose sections are parallel to its frame and whose velocity terms vanish.
template <class Space, int N>
inline void collect_frozen_station(const StationWork<Space>& sw, const typename Space::Inertia& IS,
                                   const SymmetricStation<Space>& station, int modes, typename Space::Inertia& I,
                                   typename Space::Twist& p, typename Space::Twist* C, typename Space::Scalar* G,
                                   typename Space::Scalar* h) {
  const int n = count<N>(modes);
  const typename Space::Twist* J = station.J.data();
  I += Space::shift_to_parent(station.fields.X, IS);
  p += Space::shift_to_parent(station.fields.X, sw.p);
  for (int i = 0; i < n; ++i) {
    const typename Space::Twist IJ = IS * J[i];
    C[i] += Space::shift_to_parent(station.fields.X, IJ);
    h[i] += Space::dot(J[i], sw.p);
    for (int j = 0; j <= i; ++j) G[i * n + j] += Space::dot(IJ, J[j]);
  }
}

/// (3) seen from the hinge frame M where the modes move it: A_B = X (A_M − J q̈ − σ).
template <class Space>
[[gnu::noinline, gnu::flatten]] void move_to_root(const typename Space::Frame& root, const typename Space::Twist& sigma,
                                                  int n, const typename Space::Twist* JM, typename Space::Inertia& I,
                                                  typename Space::Twist& p, typename Space::Twist* C,
                                                  typename Space::Scalar* G, typename Space::Scalar* h) {
  using Twist = typename Space::Twist;
  // Congruence with the pose of B in M.
  const typename Space::Frame B = Space::inverse(root);
  I = Space::to_parent(B, I);
  p = Space::to_parent(B, p) - I * sigma;
  for (int i = 0; i < n; ++i) C[i] = Space::to_parent(B, C[i]);
  for (int i = 0; i < n; ++i) {
    h[i] -= Space::dot(C[i], sigma) + Space::dot(JM[i], p);
    const Twist IJ = I * JM[i];
    for (int j = 0; j <= i; ++j)
      G[i * n + j] += Space::dot(IJ, JM[j]) - Space::dot(C[i], JM[j]) - Space::dot(C[j], JM[i]);
  }
  for (int i = 0; i < n; ++i) C[i] -= I * JM[i];
}

}  // namespace withy::sweep
