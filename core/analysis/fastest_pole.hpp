/// \file
/// The fastest small motion of a tree with everything that acts on it, and what makes it so: it is what steps of
/// explicit integrators must resolve.
#pragma once

#include <complex>
#include <string>

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

struct FastestPole {
  std::complex<double> value;  ///< [1/s] eigenvalue of ∂ẏ/∂y with the greatest modulus, Im ≥ 0; 0 where nothing moves
  std::size_t speed = 0;  ///< of Layout::speed_names: the coordinate with the greatest share of Σ |δ_i|² M_ii
  double share = 0;       ///< its share, 0 … 1
  /// Inertia that the motion has where that coordinate's displacement is one, |wᴴ M v| with the left and right vectors
  /// [kg m², kg], and M_ii, which the coordinate has where all others stay.
  double inertia = 0, alone = 0;
  /// What gives the greatest part of λ² wᴴ M v = −(λ wᴴ D v + wᴴ K v): "damping of load 'servo'", "stiffness of
  /// 'link1'". Of a pole that a continuous state of a load makes it is "the state of load 'servo.integral'", and
  /// nothing else but the value is set.
  std::string cause;
  bool of_load = false;  ///< a load is the cause, or may be: of those at frames and inertia no part is told
  [[nodiscard]] bool of_load_state() const;
};

/// Which speeds the model's motions prescribe, or belong to hinges that events have locked at a state.
Held driven_speeds(const Model& model, const State& state);

/// At a state, of the free speeds, with the accelerations they have there.
/// \throws std::domain_error where the mass matrix of the free speeds is singular or anything is not finite.
FastestPole fastest_pole(const TangentDynamics& dynamics, const State& state, const Held& held);

/// The same of the one with the greatest real part: what grows fastest. Its cause is what the growth is by: without a
/// little of it Re λ falls most, with λ by first-order perturbation. "inertia and weight" where it is no other's.
FastestPole growing_pole(const TangentDynamics& dynamics, const State& state, const Held& held);

/// In words: "-26911/s: damping of load 'servo' on shoulder.0, with little inertia behind it (0.011; 5.3 if the other
/// coordinates are held)".
std::string describe(const FastestPole& pole, const Layout& layout);

}  // namespace withy
