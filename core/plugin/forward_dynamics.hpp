/// \file
/// Accelerations for efforts that a caller gives: the counterpart of inverse dynamics.
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

}  // namespace withy
