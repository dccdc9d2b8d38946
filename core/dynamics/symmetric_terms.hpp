/// \file
/// Work memory of the symmetric sweep, and what enters equation (3) of symmetric_kernel.hpp: stations, sections, moving
/// roots, and the factors of a modal block.
#pragma once

#include "withy/core/dynamics/symmetric_sweep.hpp"

namespace withy::sweep {

/// Work of a station: written outward, completed inward.
template <class Space>
struct StationWork {
  StationMotion<Space> motion;
  typename Space::Twist V;      ///< twist of S
  typename Space::Twist sigma;  ///< σ_S of (2)
  typename Space::Matrix I;     ///< articulated inertia of what it carries
  typename Space::Twist p;      ///< its velocity wrench
  typename Space::Twist A;      ///< acceleration of S
};

/// Work of a node.
template <class Space>
struct NodeWork {
  JointMotion<Space> joint;
  typename Space::Twist V;  ///< twist of the hinge frame M, then of the node's frame
  typename Space::Twist V_M;
  typename Space::Twist sigma;       ///< σ of (1)
  typename Space::Twist root_sigma;  ///< σ of the root station, where the modes move it
  typename Space::Frame root;        ///< M in the node's frame, likewise
  typename Space::Matrix I;          ///< articulated inertia, rigid part
  typename Space::Twist p;
  typename Space::Twist A;
  // Elimination of ẍ: ẍ = d − gain A', A' the acceleration of M without ẍ.
  JointRows<Space> gain;
  JointVector<Space> d;
  typename Space::Twist U;  ///< one rate: column of I
  double inverse;           ///< one rate: 1 / its articulated inertia
  double u;                 ///< one rate: effort left
};

/// The arrays of one evaluation.
template <class Space>
struct SymmetricState {
  const double* positions;
  const double* speeds;
  const double* efforts;
  double* result;
  std::byte* work;
  const SymmetricNode<Space>* nodes;
  const typename Space::Twist* world;
};

/// Factors of the lower triangle of G = L Δ Lᵀ, in place: L below the diagonal, the inverse of Δ on it; false where G
/// is not positive definite. Without square roots, whose latency a small block would feel.
template <int N>
inline bool factorize(double* G, int modes) {
  const int n = count<N>(modes);
  for (int j = 0; j < n; ++j) {
    // Row j still holds L Δ to the left of the diagonal; it becomes L here.
    double d = G[j * n + j];
    for (int k = 0; k < j; ++k) {
      const double scaled = G[j * n + k];
      G[j * n + k] = scaled * G[k * n + k];
      d -= scaled * G[j * n + k];
    }
    if (!(d > 0)) return false;
    G[j * n + j] = 1 / d;
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) G[i * n + j] -= G[i * n + k] * G[j * n + k];
    }
  }
  return true;
}

/// L⁻¹ b in place, for scalars or twists.
template <int N, class T>
inline void solve_lower(const double* L, int modes, T* b) {
  const int n = count<N>(modes);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i * n + k] * b[k];
  }
}

/// Adds what a station carries to its body: equations (2) into (3).
template <class Space, int N>
inline void collect_station(const StationWork<Space>& sw, const typename Space::Frame& frame,
                            const typename Space::Twist* J, bool moving, int modes, NodeWork<Space>& w,
                            typename Space::Twist* C, double* G, double* h) {
  const int n = count<N>(modes);
  typename Space::Twist p = sw.p;
  if (moving) p += sw.I * sw.sigma;
  w.I += Space::matrix_to_parent(frame, sw.I);
  w.p += Space::to_parent(frame, p);
  for (int i = 0; i < n; ++i) {
    const typename Space::Twist IJ = sw.I * J[i];
    C[i] += Space::to_parent(frame, IJ);
    h[i] += J[i].dot(p);
    for (int j = 0; j <= i; ++j) G[i * n + j] += IJ.dot(J[j]);
  }
}

/// Rotary inertia of sections.
template <class Space, int N>
inline void collect_sections(const SymmetricNode<Space>& node, const SymmetricState<Space>& s, NodeWork<Space>& w,
                             typename Space::Twist* J, typename Space::Twist* C, double* G, double* h) {
  constexpr int A = Space::angular;
  const int n = count<N>(node.modes);
  const double* q = s.positions + node.mode_position;
  const double* q_dot = s.speeds + node.mode_speed;
  for (const RotarySection<Space>& section : node.sections) {
    StationMotion<Space> m;
    station_motion<Space, N>(section.fields, n, q, q_dot, m, J);
    const typename Space::Twist V = Space::to_child(m.frame, w.V) + m.rate;
    const typename Space::Twist sigma = Space::cross(V, m.rate) + m.bias;
    const typename Space::Angular H = section.inertia * V.template head<A>();
    typename Space::Angular moment = section.inertia * sigma.template head<A>();
    if constexpr (A == 3) moment += V.template head<3>().cross(H);
    if constexpr (A == 3) {
      w.I.template topLeftCorner<3, 3>() += m.frame.R * section.inertia * m.frame.R.transpose();
      w.p.template head<3>() += m.frame.R * moment;
    } else {
      w.I(0, 0) += section.inertia(0, 0);
      w.p[0] += moment[0];
    }
    for (int i = 0; i < n; ++i) {
      const typename Space::Angular IJ = section.inertia * J[i].template head<A>();
      if constexpr (A == 3) {
        C[i].template head<3>() += m.frame.R * IJ;
      } else {
        C[i][0] += IJ[0];
      }
      h[i] += J[i].template head<A>().dot(moment);
      for (int j = 0; j <= i; ++j) G[i * n + j] += IJ.dot(J[j].template head<A>());
    }
  }
}

/// (3) seen from the hinge frame M where the modes move it: A_B = X (A_M − J q̈ − σ).
template <class Space, int N>
inline void move_to_root(const SymmetricNode<Space>& node, NodeWork<Space>& w, const typename Space::Twist* JM,
                         typename Space::Twist* C, double* G, double* h) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  // Congruence with the pose of B in M.
  const typename Space::Frame B = Space::inverse(w.root);
  const typename Space::Matrix I = Space::matrix_to_parent(B, w.I);
  const Twist p = Space::to_parent(B, w.p) - I * w.root_sigma;
  for (int i = 0; i < n; ++i) C[i] = Space::to_parent(B, C[i]);
  for (int i = 0; i < n; ++i) {
    h[i] -= C[i].dot(w.root_sigma) + JM[i].dot(p);
    const Twist IJ = I * JM[i];
    for (int j = 0; j <= i; ++j) G[i * n + j] += IJ.dot(JM[j]) - C[i].dot(JM[j]) - C[j].dot(JM[i]);
  }
  for (int i = 0; i < n; ++i) C[i] -= I * JM[i];
  w.I = I;
  w.p = p;
}

}  // namespace withy::sweep
