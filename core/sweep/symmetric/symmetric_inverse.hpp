/// \file
/// Inverse dynamics over the nodes of a symmetric sweep: the recursive Newton–Euler algorithm with modal coordinates.
/// Equations (1) to (3) of symmetric_kernel.hpp with ẍ, q̈ given; F and the forces of stations take the place of p.
#pragma once

#include "withy/core/sweep/symmetric/symmetric_kernel.hpp"

namespace withy::sweep {

/// Accelerations of a node and its stations where all rates' are given (`efforts` of the state holds them).
template <class Space, int N, Flavor flavor>
inline void given_acceleration(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  const JointData<Space>& joint = node.joint;
  const Twist& outer = node.parent < 0 ? *s.world : *Outer(node, s).A;
  Twist A = Space::to_child(w.SM, outer) + w.A;
  if (single(joint.kind)) {
    A += along<Space>(joint.kind, joint.direction * s.efforts[joint.speed]);
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const HingeMotion motion = general_motion(joint, s.positions + joint.position, s.speeds + joint.speed);
      Twist* H = at<JointElimination<Space>>(s.work, node.work_elimination)->H;
      for (Eigen::Index i = 0; i < motion.H.cols(); ++i) {
        H[i] = Twist::of(motion.H.col(i));
        A += H[i] * s.efforts[joint.speed + static_cast<std::size_t>(i)];
      }
    }
  }
  if constexpr (flavor == Flavor::rigid) {
    w.A = A;
  } else {
    const int n = count<N>(node.modes);
    const double* a = s.efforts + node.mode_speed;
    const Twist* J = at<Twist>(s.work, node.work_J);
    if (flavor != Flavor::frozen && node.root_station >= 0) {
      const Twist* JM = J + n * static_cast<int>(node.own->stations.size());
      const auto& root = *at<RootWork<Space>>(s.work, node.work_root);
      A -= root.sigma;
      for (int i = 0; i < n; ++i) A -= JM[i] * a[i];
      A = Space::from_child(root.frame, A);
    }
    w.A = A;
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    const auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.loaded) continue;
      StationWork<Space>& sw = stations[k];
      const Twist* partial = flavor == Flavor::frozen ? station.J.data() : J + static_cast<int>(k) * n;
      sw.A =
          flavor == Flavor::frozen ? Space::shift_to_child(station.fields.X, A) : Space::to_child(frames[k], A) + sw.A;
      for (int i = 0; i < n; ++i) sw.A += partial[i] * a[i];
      // From here on p is the wrench that holds what the station carries.
      sw.p = flavor == Flavor::frozen ? Twist::zero() : sw.p + station.carried->inertia * sw.A;
    }
  }
  w.p_or_U = node.own->base->inertia * A + node.own->base->velocity_wrench(w.V);
}

/// Efforts of a node's rates, and the wrench of its hinge on the parent. `elastic`: factor of K q + D q̇.
template <class Space, int N, Flavor flavor>
[[gnu::flatten]] inline void inward_effort(const SymmetricNode<Space>& node, const SymmetricState<Space>& s,
                                           double elastic) {
  using Twist = typename Space::Twist;
  const auto& w = *at<NodeWork<Space>>(s.work, node.work);
  Twist F = w.p_or_U;
  if constexpr (flavor != Flavor::rigid) {
    const int n = count<N>(node.modes);
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    const double* a = s.efforts + node.mode_speed;
    Twist* C = at<Twist>(s.work, node.work_C);
    double* G = at<double>(s.work, node.work_G);
    double* h = at<double>(s.work, node.work_h);
    const Twist* J = at<Twist>(s.work, node.work_J);
    typename Space::Inertia I = Space::Inertia::zero();
    Twist p = Twist::zero();
    if constexpr (flavor == Flavor::frozen) {
      const auto square = Variation<Space>::bilinear(w.V, w.V);
      for (int i = 0; i < n; ++i) {
        C[i] = node.own->C0[static_cast<std::size_t>(i)];
        h[i] = -0.5 * dot(node.own->I1[static_cast<std::size_t>(i)], square);
      }
      for (int i = 0; i < n * n; ++i) G[i] = node.own->G0[static_cast<std::size_t>(i)];
    } else {
      integrate_mass<Space, N, flavor>(node, s, w.V, I, p, C, G, h);
    }
    F += I * w.A + p;
    for (int i = 0; i < n; ++i) {
      F += C[i] * a[i];
      double e = h[i] + Space::dot(C[i], w.A);
      for (int j = 0; j < n; ++j) {
        e += G[i >= j ? i * n + j : j * n + i] * a[j];
        const auto ij = static_cast<std::size_t>(i * n + j);
        e += elastic * (node.own->stiffness[ij] * q[j] + node.own->damping[ij] * q_dot[j]);
      }
      h[i] = e;
    }
    const auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    const auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
      const auto& station = node.own->stations[k];
      if (!station.loaded) continue;
      const Twist& carried = stations[k].p;
      const Twist* partial = flavor == Flavor::frozen ? station.J.data() : J + static_cast<int>(k) * n;
      F += flavor == Flavor::frozen ? Space::shift_to_parent(station.fields.X, carried)
                                    : Space::to_parent(frames[k], carried);
      for (int i = 0; i < n; ++i) h[i] += Space::dot(partial[i], carried);
    }
    if (flavor != Flavor::frozen && node.root_station >= 0) {
      // The hinge's wrench acts at M, which the modes move.
      F = Space::to_parent(Space::inverse(at<RootWork<Space>>(s.work, node.work_root)->frame), F);
      const Twist* JM = J + n * static_cast<int>(node.own->stations.size());
      for (int i = 0; i < n; ++i) h[i] -= Space::dot(JM[i], F);
    }
    for (int i = 0; i < n; ++i) s.result[node.mode_speed + static_cast<std::size_t>(i)] = h[i];
  }
  const JointData<Space>& joint = node.joint;
  if (single(joint.kind)) {
    s.result[joint.speed] = joint.direction * component<Space>(joint.kind, F);
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const Twist* H = at<JointElimination<Space>>(s.work, node.work_elimination)->H;
      for (std::size_t i = 0; i < joint.speeds; ++i) s.result[joint.speed + i] = Space::dot(H[i], F);
    }
  }
  if (joint.kind != Joint::fixed) add_reflected<Space>(joint, s.efforts[joint.speed], s.result + joint.speed);
  if (node.parent < 0) return;
  *Outer(node, s).p += Space::to_parent(w.SM, F);
}

}  // namespace withy::sweep
