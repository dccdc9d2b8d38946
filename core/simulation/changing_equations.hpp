/// \file
/// Equations of one model that change their formulation along a run. Coordinates are the same in all formulations, so
/// that the state goes over as it is.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/forwarding_equations.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/rungs.hpp"

namespace withy {

/// For faces over the equations of rungs: \throws std::invalid_argument where those are of closed loops, which an
/// integrator would not see behind the face (ClosedLoops) and let open.
void require_trees(const std::vector<Rung>& rungs);

/// The equations of the rung that is in force, under one face: a run goes on over a change with its integrator, its
/// watches and its checkpoints. `go_over` chooses the rung: of one thread, but for what a Work is of.
class ChangingEquations final : public ForwardingEquations, private LinearlyImplicit, private Linearization {
 public:
  /// \param rungs of one model, a tree; they must outlive it. \param stretches adjoin each other; at least one
  ChangingEquations(const std::vector<Rung>& rungs, std::vector<Stretch> stretches);

  /// Goes to the stretch that begins at the time [s] or has it inside.
  void go_over(double time);
  /// Index of the rung in force.
  [[nodiscard]] std::size_t rung() const { return rung_; }
  /// Made in each rung, those of the run's watches among them.
  [[nodiscard]] const std::vector<std::size_t>& evaluations() const { return evaluations_; }
  /// Puts down or takes up those counts.
  void remember(Memory& memory) { memory(evaluations_); }
  /// Times [s] at which the rung changes, increasing.
  [[nodiscard]] std::vector<double> hand_overs() const;

  [[nodiscard]] Work make_work() const override;
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    ++evaluations_[rung_];
    return own().derivatives(t, y, y_dot, work);
  }
  /// None: what the last call has left may be of another rung.
  bool found_efforts(Work& /*work*/, std::span<double> /*loads*/,
                     std::span<double> /*motions*/) const noexcept override {
    return false;
  }
  /// Null where a rung that takes part has no way to.
  [[nodiscard]] const LinearlyImplicit* linearly_implicit() const override;
  [[nodiscard]] const Linearization* linearization() const override;
  [[nodiscard]] std::unique_ptr<Observation> make_observation() const override;
  [[nodiscard]] std::unique_ptr<SensedState> make_sensed_state(std::span<const SectionPlace> sections) const override;

 private:
  class Seen;
  [[nodiscard]] const EquationsOfMotion& own() const noexcept override { return *rungs_[rung_].equations; }
  [[nodiscard]] Work make_factors() const override;
  Evaluation factorize(std::span<const double> y, double delta, Work& factors) const noexcept override {
    return own().linearly_implicit()->factorize(y, delta, factors);
  }
  void solve(std::span<double> r, Work& factors) const noexcept override {
    own().linearly_implicit()->solve(r, factors);
  }
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    ++evaluations_[rung_];
    return own().linearly_implicit()->implicit_derivatives(t, y, base, delta, y_dot, work);
  }
  Evaluation jacobian(double t, std::span<const double> y, std::span<const double> y_dot,
                      std::span<double> jacobian) const override {
    return own().linearization()->jacobian(t, y, y_dot, jacobian);
  }
  [[nodiscard]] std::vector<std::string> differenced(double t, std::span<const double> y) const override {
    return own().linearization()->differenced(t, y);
  }

  const std::vector<Rung>& rungs_;
  std::vector<Stretch> stretches_;
  std::size_t rung_ = 0;
  mutable std::vector<std::size_t> evaluations_;
};

}  // namespace withy
