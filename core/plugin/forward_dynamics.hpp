/// \file
/// Accelerations for efforts that a caller gives: the counterparts of inverse dynamics and of M a.
#pragma once

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Equations of motion that take efforts may be this too (dynamic_cast).
class ForwardDynamics {
 public:
  virtual ~ForwardDynamics() = default;
  /// Accelerations of all speeds at y where `efforts` [N m, N] act in the place of the loads', by the recursion of
  /// EquationsOfMotion::derivatives and in its time. Speeds that motions prescribe have those given in `u_dot`.
  virtual Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts,
                                      std::span<double> u_dot, Work& work) const noexcept = 0;
};

/// Equations of motion with a symmetric mass matrix may be this too (dynamic_cast): M⁻¹ for many right-hand sides, each
/// in time proportional to the number of bodies.
class MassSolver {
 public:
  virtual ~MassSolver() = default;
  /// Bytes of memory for the factors; 0 where these equations' mass matrix is not symmetric.
  [[nodiscard]] virtual std::size_t mass_factors_size() const = 0;
  /// Factors of M(y).
  virtual Evaluation factorize_mass(std::span<const double> y, Work& factors) const noexcept = 0;
  /// Sets a = M⁻¹ f, one number a speed; zero on speeds that motions prescribe, as if they did not move.
  virtual void accelerate(std::span<const double> forces, std::span<double> accelerations,
                          Work& factors) const noexcept = 0;
};

}  // namespace withy
