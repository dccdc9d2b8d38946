/// \file
/// The interface of integrators.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"

namespace withy {

/// How a step ended.
struct StepResult {
  enum class Outcome {
    ok,
    nonfinite,      ///< the derivatives are not finite, however small the step
    singular,       ///< the mass matrix cannot be solved, however small the step
    step_underflow  ///< the accuracy asked for needs steps below the resolution of time
  };
  Outcome outcome = Outcome::ok;
  int body = -1;  ///< the body an evaluation blamed, by its index in Model::bodies(), or −1
};

/// What an integration has cost so far.
struct StepStatistics {
  std::size_t accepted = 0;
  std::size_t rejected = 0;
  std::size_t evaluations = 0;
  double smallest_step = 0;  ///< [s], of the accepted ones
  double largest_step = 0;   ///< [s]
  int determinant_sign = 1;  ///< of M at the last accepted state
};

/// One integration under way. It owns its work arrays; stepping allocates nothing, but for what Linearization does.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Advances by one accepted step, not past t_limit [s] and landing on it exactly where it is reached. The state keeps
  /// its count of numbers. After a result other than ok it is the last accepted one.
  virtual StepResult step(double t_limit) = 0;
  [[nodiscard]] virtual const State& state() const = 0;
  /// State inside the last accepted step, t between its ends, to the accuracy the integrator states. Discrete states
  /// are those of the step, bit by bit (keep_discrete_states).
  virtual void interpolate(double t, std::span<double> y) const = 0;
  /// Forgets what was learnt of the right-hand side's smoothness: call at a discontinuity, after its time is reached.
  virtual void restart() = 0;
  /// Goes to another state, its quaternions of unit length, and begins there as after `restart`: back to an event
  /// within the last step, or where the state itself jumps.
  virtual void jump(const State& state) = 0;
  /// What the stepper knows beyond its state, its statistics among it. Taken up with the state by `resume`, a stepper
  /// of the same integrator and equations goes on as this one would, bit by bit.
  [[nodiscard]] virtual std::vector<double> memory() const = 0;
  /// \throws std::invalid_argument where these numbers are no memory of such a stepper.
  virtual void resume(const State& state, std::span<const double> memory) = 0;
  [[nodiscard]] virtual const StepStatistics& statistics() const = 0;
  /// Work memory in which the last evaluation was that of the derivatives at state(), at a jump those before it; null
  /// where it was another. Reading what it holds spares an evaluation (EquationsOfMotion::found_efforts).
  [[nodiscard]] virtual Work* evaluated() const { return nullptr; }
  /// What a user should know of how it integrates these equations, a sentence each: that it does without an exact
  /// Jacobian where one was asked for.
  [[nodiscard]] virtual std::vector<std::string> remarks() const { return {}; }
};

/// An integration method with its options.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Begins at `state`; `equations` must outlive the stepper. Never null.
  /// \throws std::invalid_argument where it cannot treat these equations; the text says why.
  [[nodiscard]] virtual std::unique_ptr<Stepper> start(const EquationsOfMotion& equations,
                                                       const State& state) const = 0;
  /// Order of accuracy of a step.
  [[nodiscard]] virtual int order() const = 0;
  /// Greatest h ω, positive, up to which an undamped vibration of frequency ω grows by no more than 1 % a step.
  /// Infinite where no step is too long; nothing where it is not known.
  [[nodiscard]] virtual std::optional<double> stability_limit() const { return {}; }
};

}  // namespace withy
