/// \file
/// Small motions of closed loops about rest, in as many speeds as are independent.
///
/// With g(x) = 0 the closing equations and J their derivative by displacements, speeds of closed loops are u = T u_I,
///   T = [1; −J_D⁻¹ J_I]                                                    (1)
/// for independent speeds I and the others, D. The residual of the tree is what the loops exert, r(x, u, u̇) = Jᵀ λ, and
/// Tᵀ Jᵀ = 0, so that small motions about rest are those of
///   Tᵀ M T δ̈ + Tᵀ G T δ̇ + Tᵀ (K − ∂(Jᵀ λ)/∂x) T δ + Tᵀ M (∂T/∂x · T δ) u̇_I = 0   (2)
/// with M, G, K of the tree and λ constant; the last term is zero in equilibrium.
#pragma once

#include <vector>

#include "withy/core/analysis/steady_state.hpp"
#include "withy/core/plugin/closed_loops.hpp"

namespace withy {

/// What loops leave free at a state.
struct LoopChart {
  std::vector<Eigen::Index> independent;  ///< speeds
  Eigen::MatrixXd T;                      ///< speeds × independent
  Held held;                              ///< all speeds but these
};

/// Of equations whose loops are closed, speeds and prescribed accelerations zero. What it is made of must outlive it.
class LoopMotions {
 public:
  /// \throws std::bad_cast where the equations have no loops.
  LoopMotions(const EquationsOfMotion& equations, const TangentDynamics& dynamics, Held held);

  /// The independent speeds are those that the closing equations say least about, by the pivots of J in units of
  /// √M_ii; or those given.
  [[nodiscard]] LoopChart chart(const State& state, const std::vector<Eigen::Index>& independent = {}) const;
  /// Accelerations of all speeds from rest. \throws std::domain_error where the mass matrix is singular.
  [[nodiscard]] Eigen::VectorXd accelerations(const State& state) const;
  /// (2), in the rows and columns of the independent speeds; all others are zero.
  /// \param tangents of the tree at the state and these accelerations
  [[nodiscard]] Tangents reduced(const Tangents& tangents, const State& state, const Eigen::VectorXd& accelerations,
                                 const LoopChart& chart) const;
  /// Static equilibrium, as find_steady_state: Newton's method in (2), the loops closed after each step by the least
  /// displacement in units of √M_ii.
  [[nodiscard]] SteadyState rest(const State& start) const;

 private:
  struct Seen {
    Eigen::VectorXd gaps;
    Eigen::MatrixXd J;  ///< equations × speeds, zero where held
  };
  class Balance;
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(held_.size()); }
  [[nodiscard]] Seen see(const State& state) const;
  [[nodiscard]] Eigen::VectorXd multipliers(const Eigen::MatrixXd& J, const Eigen::VectorXd& residual) const;
  /// Tᵀ ∂(Jᵀ λ)/∂x T.
  [[nodiscard]] Eigen::MatrixXd curvature(const State& state, const LoopChart& chart,
                                          const Eigen::VectorXd& lambda) const;
  [[nodiscard]] double step(const LoopChart& chart, Eigen::Index i) const;
  [[nodiscard]] State moved(const State& state, const Eigen::VectorXd& displacement) const;
  bool close(State& state) const;
  double advance(const Balance& balance, const Eigen::VectorXd& step, State& state) const;

  const EquationsOfMotion& equations_;
  const ClosedLoops& loops_;
  const TangentDynamics& dynamics_;
  Held held_;
  std::vector<Eigen::Index> free_;
  mutable Work work_;
};

}  // namespace withy
