/// \file
/// Reactions of all hinges of a model, and what is inside its bodies, at one state in the order that its formulation
/// keeps.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/kinematics/sensed_wrenches.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy::equations {

/// The inertia of untruncated and ruthless bodies is told in numbers with their rates in time, that of strict and
/// symmetric truncation in numbers of first order with their rates; weight and loads in the scalars of FramePaths.
class SensedReactions {
 public:
  SensedReactions(const sensed::Plan& plan, const AppliedLoads& loads);

  /// Goes to a state with these accelerations.
  void observe(const State& state, std::span<const double> accelerations) noexcept;
  /// Adds what wrenches at frames, about their origins in world axes, ask of hinges and sections: wrenches that know no
  /// truncation, as those of closed loops.
  void add(const State& state, std::span<const FrameIndex> frames, std::span<const Wrench> wrenches) noexcept;
  /// What the parent exerts on the child through a hinge, about M's origin in F's axes.
  [[nodiscard]] Wrench of_hinge(std::size_t hinge) const noexcept { return reactions_[hinge]; }
  /// SectionLoad::inner of a cut of the plan.
  [[nodiscard]] Wrench of_section(std::size_t cut) const noexcept { return sections_[cut]; }

 private:
  template <class S>
  struct Part {
    explicit Part(const sensed::Plan& plan) : pass(plan), total(plan.bodies.size()) {}
    sensed::Pass<S> pass;
    std::vector<sensed::TwistOf<S>> total;
  };
  template <class S>
  void find_inertia(Part<S>& part, const State& state, std::span<const double> accelerations) noexcept;
  template <class S>
  void find_applied(Part<S>& part, const State& state) noexcept;
  /// Takes wrenches at frames, and with `weight` that of the bodies, off what hinges and sections bear.
  template <class S>
  void take_off(Part<S>& part, std::span<const FrameIndex> frames, std::span<const Wrench> wrenches,
                bool weight) noexcept;
  /// What loads on distributed mass exert on the parts beyond cuts that have mass points of their own.
  void find_on_parts(const State& state) noexcept;
  /// Of what hangs on the part beyond a cut, `own` being the part's own; about the section, in its axes.
  template <class S>
  [[nodiscard]] sensed::TwistOf<S> at_cut(const Part<S>& part, const sensed::CutPlan& cut,
                                          sensed::TwistOf<S> own) const noexcept;

  const sensed::Plan& plan_;
  const AppliedLoads& loads_;
  Work work_;
  std::vector<Wrench> reactions_, sections_;
  std::vector<double> no_accelerations_;
  std::vector<Wrench> on_parts_;  ///< cut after cut, world axes
  std::optional<Part<double>> plain_, untruncated_, shown_;
  std::optional<Part<sensed::First>> first_, applied_first_;
  std::optional<Part<sensed::Second>> second_, applied_second_;
};

}  // namespace withy::equations
