/// \file
/// Forward dynamics of the kinetic energy of first order, T = ½ uᵀ(M₀(x) + M₁(x, q))u (truncation `symmetric`), in time
/// proportional to the number of bodies.
///
/// In dual numbers, ε marking q in all poses, partial velocities and mass integrals but not the rates, T is the sum ⟨·⟩
/// of both orders of the bodies' ½ Vᵀ I V + Vᵀ C q̇ + ½ q̇ᵀ G q̇. Twists and accelerations V = V0 + εV1, A likewise:
///   hinge     V_M = X V_F + H ẋ,             A_M = X A_F + H ẍ + V_M × H ẋ + Ḣ ẋ
///   station   V_S = X V_B + J q̇,             A_S = X A_B + J q̈ + ε (V_S × J q̇ + J′[q̇] q̇),  X = (1 − εξ×) X0, ξ = J0 q
///   body      p = I V + C q̇,                 F = I A + C q̈ + V ×* p + ε (I′[q̇] V + C′[q̇] q̇)
/// The rates q̇ being ε⁻¹ times those of the poses, J q̇ is no velocity of a frame, and Lagrange's equations have beside
/// F the momentum P_S of all that a station carries:
///   F_B += Xᵀ (F_S − (1 − ε) (J q̇) ×* P_S),       Q_q += Jᵀ (F_S − (1 − ε) V_S ×* P_S)
/// (1 − ε)w has the orders w0, w1 − w0. All is linear in the pair (A0, A1), and what answers to it, (F0 + F1, F0), by a
/// symmetric matrix: the articulated-body recursion applies to pairs, and its pivots are those of M₀ + M₁.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/sweep/first_order/first_order_algebra.hpp"
#include "withy/core/sweep/first_order_constants.hpp"
#include "withy/core/sweep/joint_step.hpp"

namespace withy::sweep {

/// A station: everything at q = 0 and its first derivatives.
template <class Space>
struct FirstOrderStation {
  Fields<Space> fields;                    ///< its axes parallel to the node's frame
  SharedNumbers<typename Space::Twist> J;  ///< at q = 0, section axes
  std::vector<typename Space::Twist> J1;   ///< ∂J_i/∂q_k, element k n + i
  bool has_children = false;
  double carried = 0;  ///< mass of all that hangs on it [kg]
};

template <class Space>
struct FirstOrderNode : FirstOrderConstants<Space> {
  std::vector<double> G1;                                  ///< ∂G_ij/∂q_k, element (k n + i) n + j
  std::vector<typename Space::Position> moment1, moment2;  ///< derivatives of the first moment of mass
  double mass = 0;                                         ///< of it and all that hangs on it [kg]
  std::vector<FirstOrderStation<Space>> stations;
  std::size_t work = 0, work_stations = 0, work_J1 = 0, work_Y = 0, work_G = 0, work_y = 0, work_elimination = 0;

  FirstOrderNode(const NodeSpec& spec, Terms terms, const Invariants& invariants);
};

template <class Space>
struct FirstOrderState;

/// The sweep over all nodes. Stations carry children only: rigid bodies are in the invariants.
template <class Space>
class FirstOrderSweep {
 public:
  FirstOrderSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity);
  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  /// What was computed once for all evaluations, a line each.
  static std::vector<std::string> savings(const NodeTree& tree) { return savings_of_first_order(tree); }
  /// As SymmetricSweep: accelerations, with M + δ D + δ² K in the place of M = M₀ + M₁, which may be
  /// indefinite: the evaluation says the sign of its determinant.
  Evaluation accelerations(const double* positions, const double* speeds, double* efforts, double delta, double* result,
                           std::byte* work) const noexcept;
  void inverse(const double* positions, const double* speeds, const double* accelerations, bool inertial,
               double* efforts, std::byte* work) const noexcept;
  /// The potential of weight, of second order in the elastic coordinates, from the world's origin [J].
  double weight_potential(const double* positions, const double* at_rest, std::byte* work) const noexcept;
  Evaluation factorize(const double* positions, const double* at_rest, double delta, std::byte* work) const noexcept;
  void solve(const double* forces, double delta, double* result, std::byte* work) const noexcept;

 private:
  /// The first pass: poses, velocities, velocity wrenches.
  void move(const FirstOrderState<Space>& state) const noexcept;
  /// Sets the efforts of weight, one a speed, where the first pass has been.
  void find_weight(const FirstOrderState<Space>& state, double* weight) const noexcept;
  Evaluation inward(const FirstOrderState<Space>& state) const noexcept;
  void outward(const FirstOrderState<Space>& state) const noexcept;

  std::vector<FirstOrderNode<Space>> nodes_;
  typename Space::Position gravity_;
  bool heavy_ = false;
  std::size_t speeds_ = 0, weight_offset_ = 0;
  std::size_t work_size_ = 0;
};

extern template class FirstOrderSweep<Spatial>;
extern template class FirstOrderSweep<Planar>;

}  // namespace withy::sweep
