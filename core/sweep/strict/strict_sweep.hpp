/// \file
/// Forward dynamics under strict first-order truncation, in time proportional to the number of bodies although the mass
/// matrix is not symmetric.
///
/// Theory (3) counts q, q̇ and q̈ as first order and adds the two orders of every equation. Let A0 be the acceleration
/// that ẍ alone gives the undeformed tree, and Ā = A0 + A1 the sum with its first-order part, in which q̈ enters; F0 and
/// F̄ = F0 + F1 likewise. Every relation of the tree is then linear in the pairs (Ā, A0) and (F̄, F0):
///   hinge     Ā_M = X Ā_F + H ẍ + σ̄,                     A0_M = X A0_F + H ẍ + σ0,         Hᵀ F̄ = τ
///   station   Ā_S = X Ā_B − ξ × X A0_B + J q̈ + σ1,       A0_S = X A0_B,                    ξ = J q
///             F̄_B += Xᵀ (F̄_S + ξ ×* F0_S),               F0_B += Xᵀ F0_S
///   body      F̄ = I0 Ā + I1 A0 + C0 q̈ + p̄,               F0 = I0 A0 + p0
///             −K q − D q̇ = C0ᵀ Ā + C1ᵀ A0 + G0 q̈ + h      (+ Jᵀ F̄_S + J1ᵀ F0_S at stations)
/// so a subtree answers F̄ = P Ā + Q A0 + p̄, F0 = R Ā + T A0 + p0, and each body's (ẍ, q̈) is eliminated once, as in the
/// symmetric recursion, with four matrices in the place of one.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/sweep/first_order_constants.hpp"
#include "withy/core/sweep/joint_step.hpp"

namespace withy::sweep {

/// A station in a strict sweep: everything at q = 0 and its first derivative. Twists in the section's axes.
template <class Space>
struct StrictStation {
  typename Space::Position X;             ///< undeformed, its axes parallel to the node's frame
  std::vector<typename Space::Twist> J;   ///< at q = 0
  std::vector<typename Space::Twist> J1;  ///< ∂J_i/∂q_k, element k n + i
  bool has_children = false;
};

template <class Space>
struct StrictNode : FirstOrderConstants<Space> {
  bool leaf = true;  ///< nothing hangs on it
  std::vector<Variation<Space>> I2;
  std::vector<StrictStation<Space>> stations;
  std::size_t work = 0, work_stations = 0, work_vectors = 0, work_scalars = 0;

  StrictNode(const NodeSpec& spec, Terms terms, const Invariants& invariants);
};

/// The sweep over all nodes. Stations carry children only: rigid bodies are in the invariants.
template <class Space>
class StrictSweep {
 public:
  StrictSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity);
  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  /// What was computed once for all evaluations, a line each.
  static std::vector<std::string> savings(const NodeTree& tree) { return savings_of_first_order(tree); }
  /// Accelerations of all speeds from positions, speeds and applied efforts. Those of driven speeds are given in
  /// `result`; all efforts on them, the applied ones among them, are left in `efforts`.
  Evaluation accelerations(const double* positions, const double* speeds, double* efforts, double* result,
                           std::byte* work) const noexcept;
  /// Inverse dynamics: the applied efforts under which `accelerations` are those of the speeds, or, `inertial`, M times
  /// `accelerations` (the speeds then all zero).
  void inverse(const double* positions, const double* speeds, const double* accelerations, bool inertial,
               double* efforts, std::byte* work) const noexcept;

 private:
  std::vector<StrictNode<Space>> nodes_;
  typename Space::Twist world_acceleration_;
  std::size_t work_size_ = 0, speeds_ = 0;
};

extern template class StrictSweep<Spatial>;
extern template class StrictSweep<Planar>;

}  // namespace withy::sweep
