/// \file
/// The three passes of the symmetric sweep over one node; see symmetric_sweep.hpp.
///
/// At a node, with V, A its frame's twist and acceleration, F the wrench the hinge passes to it, u̇ = (ẍ, q̈):
///   (1) V_M = X V_S + H ẋ,              A_M = X A_S + H ẍ + σ,   σ = V_M × H ẋ + Ḣ ẋ
///   (2) V_S = X V_B + J q̇,              A_S = X A_B + J q̈ + σ_S, σ_S = V_S × J q̇ + J̇ q̇      (station S of body B)
///   (3) F = I A + C q̈ + p,              −K q − D q̇ = Cᵀ A + G q̈ + h
/// Children and carried bodies enter (3) through their stations; then q̈, then ẍ are eliminated. The passes are
/// outward_motion, inward_inertia, and outward_acceleration, which stands here.
#pragma once

#include "withy/core/sweep/symmetric/symmetric_elimination.hpp"

namespace withy::sweep {

template <class Space, int N, Flavor flavor>
[[gnu::flatten]] inline void outward_acceleration(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  using Scalar = typename Space::Scalar;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  const JointData<Space>& joint = node.joint;
  const Twist& outer = node.parent < 0 ? *s.world : *Outer(node, s).A;
  Twist A = w.A;
  if (joint.pose_matters) A += Space::to_child(w.SM, outer);
  if (joint.driven) [[unlikely]] {
    if (s.driven != nullptr) {
      const auto& asked = *at<DrivenWork<Space>>(s.work, node.work_driven);
      driven_efforts<Space>(joint, s.positions + joint.position, s.speeds + joint.speed, asked.I * A + asked.p,
                            s.driven + joint.speed);
      add_reflected<Space>(joint, s.result[joint.speed], s.driven + joint.speed);
    } else {
      for (std::size_t i = 0; i < joint.speeds; ++i) s.result[joint.speed + i] = 0;
    }
  } else if (single(joint.kind)) {
    const auto x = (w.u - Space::dot(w.p_or_U, A)) * w.inverse;
    A += along<Space>(joint.kind, x);
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (has_general_hinges<Space>) {
    if (joint.kind != Joint::fixed) {
      const auto& e = *at<JointElimination<Space>>(s.work, node.work_elimination);
      Scalar* x = s.result + joint.speed;
      back_substitute<-1, Space>(e.L, e.Y, e.y, static_cast<int>(joint.speeds), A, x);
      for (std::size_t i = 0; i < joint.speeds; ++i) A += e.H[i] * x[i];
    }
  }
  if constexpr (flavor == Flavor::rigid) {
    w.A = A;
    return;
  } else {
    const bool constant = flavor == Flavor::frozen && is_constant(node, s);
    const Scalar* L = constant ? node.own->factor.data() : at<Scalar>(s.work, node.work_G);
    const Twist* Y = constant ? node.own->Y0.data() : at<Twist>(s.work, node.work_C);
    Scalar* a = s.result + node.mode_speed;
    back_substitute<N, Space>(L, Y, at<Scalar>(s.work, node.work_y), n, A, a);
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    const auto* frames = at<typename Space::Frame>(s.work, node.work_frames);
    if constexpr (flavor == Flavor::frozen) {
      w.A = A;
      for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
        const auto& station = node.own->stations[k];
        if (!station.has_children) continue;
        Twist AS = Space::shift_to_child(station.fields.X, A);
        for (int i = 0; i < n; ++i) AS += station.J[static_cast<std::size_t>(i)] * a[i];
        stations[k].A = AS;
      }
    } else {
      const Twist* J = at<Twist>(s.work, node.work_J);
      if (node.root_station >= 0) {
        const Twist* JM = J + n * static_cast<int>(node.own->stations.size());
        const auto& root = *at<RootWork<Space>>(s.work, node.work_root);
        A -= root.sigma;
        for (int i = 0; i < n; ++i) A -= JM[i] * a[i];
        A = Space::from_child(root.frame, A);
      }
      w.A = A;
      for (std::size_t k = 0; k < node.own->stations.size(); ++k) {
        if (!node.own->stations[k].has_children) continue;
        Twist AS = Space::to_child(frames[k], A) + stations[k].A;
        for (int i = 0; i < n; ++i) AS += J[static_cast<int>(k) * n + i] * a[i];
        stations[k].A = AS;
      }
    }
  }
}

}  // namespace withy::sweep
