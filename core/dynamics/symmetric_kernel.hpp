/// \file
/// The three passes of the symmetric sweep over one node; see symmetric_sweep.hpp.
///
/// At a node, with V, A its frame's twist and acceleration, F the wrench the hinge passes to it, u̇ = (ẍ, q̈):
///   (1) V_M = X V_S + H ẋ,              A_M = X A_S + H ẍ + σ,   σ = V_M × H ẋ + Ḣ ẋ
///   (2) V_S = X V_B + J q̇,              A_S = X A_B + J q̈ + σ_S, σ_S = V_S × J q̇ + J̇ q̇      (station S of body B)
///   (3) F = I A + C q̈ + p,              −K q − D q̇ = Cᵀ A + G q̈ + h
/// Children and carried bodies enter (3) through their stations; then q̈, then ẍ are eliminated.
#pragma once

#include "withy/core/dynamics/symmetric_terms.hpp"

namespace withy::sweep {

/// Constant elimination of a frozen leaf's modes.
template <class Space>
void precompute(SymmetricNode<Space>& node) {
  node.factor = node.G0;
  node.Y0 = node.C0;
  node.reduced = node.base;
  if (!factorize<-1>(node.factor.data(), node.modes)) {
    node.factor.clear();  // the sweep meets the same pivot and reports it
    return;
  }
  solve_lower<-1>(node.factor.data(), node.modes, node.Y0.data());
  for (int i = 0; i < node.modes; ++i) {
    const auto& y = node.Y0[static_cast<std::size_t>(i)];
    node.reduced -= y * (node.factor[static_cast<std::size_t>(i * node.modes + i)] * y).transpose();
  }
}

template <class Space, int N>
[[gnu::flatten]] inline void outward_motion(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  joint_motion<Space>(node.joint, s.positions + node.joint.position, s.speeds + node.joint.speed, w.joint);
  if (node.parent < 0) {
    w.V_M = w.joint.rate;
  } else {
    const SymmetricNode<Space>& parent = s.nodes[node.parent];
    const Twist& V = node.parent_station < 0
                         ? at<NodeWork<Space>>(s.work, parent.work)->V
                         : at<StationWork<Space>>(s.work, parent.work_stations)[node.parent_station].V;
    w.V_M = Space::to_child(w.joint.SM, V) + w.joint.rate;
  }
  w.sigma = Space::cross(w.V_M, w.joint.rate) + w.joint.bias;
  w.V = w.V_M;

  const double* q = s.positions + node.mode_position;
  const double* q_dot = s.speeds + node.mode_speed;
  auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
  Twist* J = at<Twist>(s.work, node.work_J);
  if constexpr (N != 0) {
    if (node.root_station >= 0) {
      // The root section moves with q: V_M = X V_B + J q̇, solved for V_B.
      const auto& root = node.stations[static_cast<std::size_t>(node.root_station)];
      StationMotion<Space> m;
      Twist* JM = J + n * static_cast<int>(node.stations.size());
      station_motion<Space, N>(root.fields, n, q, q_dot, m, JM);
      const typename Space::Frame section{node.M};
      const Twist rate = Space::to_child(section, m.rate);
      w.root = Space::compose(m.frame, section);
      w.root_sigma = Space::cross(w.V_M, rate) + Space::to_child(section, m.bias);
      for (int i = 0; i < n; ++i) JM[i] = Space::to_child(section, JM[i]);
      w.V = Space::from_child(w.root, w.V_M - rate);
    }
  }
  for (std::size_t k = 0; k < node.stations.size(); ++k) {
    const auto& station = node.stations[k];
    if (!station.loaded) continue;
    StationWork<Space>& sw = stations[k];
    if (node.frozen) {
      sw.V = Space::to_child(station.frozen.frame, w.V);
      sw.I.setZero();
      sw.p.setZero();
    } else {
      station_motion<Space, N>(station.fields, n, q, q_dot, sw.motion, J + static_cast<int>(k) * n);
      sw.V = Space::to_child(sw.motion.frame, w.V) + sw.motion.rate;
      sw.sigma = Space::cross(sw.V, sw.motion.rate) + sw.motion.bias;
      sw.I = station.carried;
      sw.p = Space::cross_force(sw.V, station.carried * sw.V);
    }
  }
  w.I = node.base;
  w.p = Space::cross_force(w.V, node.base * w.V);
}

template <class Space, int N>
[[gnu::flatten]] inline bool inward_inertia(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  using Matrix = typename Space::Matrix;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  if constexpr (N != 0) {
    const double* q = s.positions + node.mode_position;
    const double* q_dot = s.speeds + node.mode_speed;
    const auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    Twist* J = at<Twist>(s.work, node.work_J);
    Twist* C = at<Twist>(s.work, node.work_C);
    double* G = at<double>(s.work, node.work_G);
    double* y = at<double>(s.work, node.work_y);
    const bool constant = !node.factor.empty();
    const double* L = constant ? node.factor.data() : G;
    const Twist* Y = constant ? node.Y0.data() : C;
    if (node.frozen) {
      const auto square = Variation<Space>::bilinear(w.V, w.V);
      for (int i = 0; i < n; ++i) y[i] = -0.5 * node.I1[static_cast<std::size_t>(i)].a.dot(square);
      if (!constant) {
        for (int i = 0; i < n; ++i) C[i] = node.C0[static_cast<std::size_t>(i)];
        for (int i = 0; i < n * n; ++i) G[i] = node.G0[static_cast<std::size_t>(i)];
        for (std::size_t k = 0; k < node.stations.size(); ++k) {
          if (!node.stations[k].loaded) continue;
          collect_station<Space, N>(stations[k], node.stations[k].frozen.frame, node.stations[k].frozen_J.data(), false,
                                    n, w, C, G, y);
        }
      }
    } else {
      for (int i = 0; i < n; ++i) {
        C[i].setZero();
        y[i] = 0;
      }
      for (int i = 0; i < n * n; ++i) G[i] = 0;
      integrate<Space, N>(node.mass, n, q, q_dot, w.V, at<Pack>(s.work, node.work_P), w.I, C, G, w.p, y);
      for (std::size_t k = 0; k < node.stations.size(); ++k) {
        if (!node.stations[k].loaded) continue;
        collect_station<Space, N>(stations[k], stations[k].motion.frame, J + static_cast<int>(k) * n, true, n, w, C, G,
                                  y);
      }
      Twist* JM = J + n * static_cast<int>(node.stations.size());
      collect_sections<Space, N>(node, s, w, C + n, C, G, y);
      if (node.root_station >= 0) move_to_root<Space, N>(node, w, JM, C, G, y);
    }
    // q̈ = G⁻¹ (−K q − D q̇ − h − Cᵀ A), with G = L Δ Lᵀ, Y = L⁻¹ Cᵀ, y = L⁻¹ (…).
    for (int i = 0; i < n; ++i) {
      double e = s.efforts[node.mode_speed + static_cast<std::size_t>(i)] - y[i];
      for (int j = 0; j < n; ++j) {
        e -= node.stiffness[static_cast<std::size_t>(i * n + j)] * q[j] +
             node.damping[static_cast<std::size_t>(i * n + j)] * q_dot[j];
      }
      y[i] = e;
    }
    if (!constant) {
      if (!factorize<N>(G, n)) return false;
      solve_lower<N>(G, n, C);
    }
    solve_lower<N>(L, n, y);
    if (constant) {
      w.I = node.reduced;
    } else {
      for (int i = 0; i < n; ++i) w.I -= Y[i] * (L[i * n + i] * Y[i]).transpose();
    }
    for (int i = 0; i < n; ++i) w.p += Y[i] * (L[i * n + i] * y[i]);
  }

  // Elimination of ẍ, and what the hinge passes to the parent's station: inertia Ia, wrench pa at zero A'.
  Matrix Ia = w.I;
  Twist pa = w.p;
  const JointData<Space>& joint = node.joint;
  if (single(joint.kind)) {
    const int row = JointData<Space>::row(joint.kind);
    w.U = w.I.col(row);
    if (!(w.U[row] > 0)) return false;
    w.inverse = 1 / w.U[row];
    w.u = joint.direction * s.efforts[joint.speed] - w.p[row];
    if (node.parent < 0) return true;
    const Twist scaled = w.U * w.inverse;
    Ia -= scaled * w.U.transpose();
    pa += Ia * w.sigma + scaled * w.u;
  } else if (joint.kind == Joint::fixed) {
    if (node.parent < 0) return true;
    pa += Ia * w.sigma;
  } else if constexpr (Space::angular == 3) {  // a planar tree has no other hinges
    const JointColumns<Space> H = motion_subspace<Space>(joint, s.positions + joint.position, s.speeds + joint.speed);
    const JointColumns<Space> U = w.I * H;
    const JointMatrix<Space> D = H.transpose() * U;
    const Eigen::LLT<JointMatrix<Space>> llt(D);
    if (llt.info() != Eigen::Success) return false;
    const JointVector<Space> effort =
        Eigen::Map<const Eigen::VectorXd>(s.efforts + joint.speed, static_cast<Eigen::Index>(joint.speeds)) -
        H.transpose() * w.p;
    w.gain = llt.solve(JointRows<Space>(U.transpose()));
    w.d = llt.solve(effort);
    if (node.parent < 0) return true;
    Ia -= U * w.gain;
    pa += Ia * w.sigma + U * w.d;
  }
  const SymmetricNode<Space>& parent = s.nodes[node.parent];
  Matrix* I = nullptr;
  Twist* p = nullptr;
  if (node.parent_station < 0) {
    auto& pw = *at<NodeWork<Space>>(s.work, parent.work);
    I = &pw.I;
    p = &pw.p;
  } else {
    auto& pw = at<StationWork<Space>>(s.work, parent.work_stations)[node.parent_station];
    I = &pw.I;
    p = &pw.p;
  }
  *I += Space::matrix_to_parent(w.joint.SM, Ia);
  *p += Space::to_parent(w.joint.SM, pa);
  return true;
}

template <class Space, int N>
[[gnu::flatten]] inline void outward_acceleration(const SymmetricNode<Space>& node, const SymmetricState<Space>& s) {
  using Twist = typename Space::Twist;
  const int n = count<N>(node.modes);
  auto& w = *at<NodeWork<Space>>(s.work, node.work);
  const JointData<Space>& joint = node.joint;
  const Twist* outer = s.world;
  if (node.parent >= 0) {
    const SymmetricNode<Space>& parent = s.nodes[node.parent];
    outer = node.parent_station < 0 ? &at<NodeWork<Space>>(s.work, parent.work)->A
                                    : &at<StationWork<Space>>(s.work, parent.work_stations)[node.parent_station].A;
  }
  Twist A = Space::to_child(w.joint.SM, *outer) + w.sigma;
  if (single(joint.kind)) {
    const double x = (w.u - w.U.dot(A)) * w.inverse;
    A[JointData<Space>::row(joint.kind)] += x;
    s.result[joint.speed] = joint.direction * x;
  } else if constexpr (Space::angular == 3) {
    if (joint.kind != Joint::fixed) {
      const JointVector<Space> x = w.d - w.gain * A;
      A += motion_subspace<Space>(joint, s.positions + joint.position, s.speeds + joint.speed) * x;
      for (Eigen::Index i = 0; i < x.size(); ++i) s.result[joint.speed + static_cast<std::size_t>(i)] = x[i];
    }
  }
  w.A = A;
  if constexpr (N != 0) {
    const bool constant = !node.factor.empty();
    const double* L = constant ? node.factor.data() : at<double>(s.work, node.work_G);
    const Twist* Y = constant ? node.Y0.data() : at<Twist>(s.work, node.work_C);
    const double* y = at<double>(s.work, node.work_y);
    double* a = s.result + node.mode_speed;
    for (int i = 0; i < n; ++i) a[i] = L[i * n + i] * (y[i] - Y[i].dot(A));
    for (int i = n; i-- > 0;) {
      for (int k = i + 1; k < n; ++k) a[i] -= L[k * n + i] * a[k];
    }
    const Twist* J = at<Twist>(s.work, node.work_J);
    if (node.root_station >= 0) {
      const Twist* JM = J + n * static_cast<int>(node.stations.size());
      Twist relative = A - w.root_sigma;
      for (int i = 0; i < n; ++i) relative -= JM[i] * a[i];
      w.A = Space::from_child(w.root, relative);
    }
    auto* stations = at<StationWork<Space>>(s.work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) {
      if (!node.stations[k].has_children) continue;
      StationWork<Space>& sw = stations[k];
      if (node.frozen) {
        sw.A = Space::to_child(node.stations[k].frozen.frame, w.A);
        for (int i = 0; i < n; ++i) sw.A += node.stations[k].frozen_J[static_cast<std::size_t>(i)] * a[i];
      } else {
        sw.A = Space::to_child(sw.motion.frame, w.A) + sw.sigma;
        for (int i = 0; i < n; ++i) sw.A += J[static_cast<int>(k) * n + i] * a[i];
      }
    }
  }
}

}  // namespace withy::sweep
