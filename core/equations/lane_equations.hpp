/// \file
/// Equations of motion of several cases evaluated at once, a lane of a vector register each.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "withy/core/kinematics/lane_energies.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/staged_steps.hpp"

namespace withy {

/// An evaluation that a case asks for: EquationsOfMotion::derivatives with its arguments and its result.
struct LaneCall {
  double t = 0;  ///< [s]
  std::span<const double> y;
  std::span<double> y_dot;
  Work* work = nullptr;  ///< of the case's own equations; holds afterwards what their own evaluation would leave there
  Evaluation evaluation;
};

/// A whole step that a case asks for: StagedSteps::stages with its argument and its result.
struct LaneStep {
  const StagedSteps::Step* step = nullptr;  ///< `work` is that of the case's own equations
  StagedSteps::Outcome outcome;
};

/// Cases whose equations differ in numbers only, lane_count() of them. What a case gets does not depend, to the last
/// bit, on its lane, on the others, on how many there are or on when they came. It agrees with the case's own
/// EquationsOfMotion::derivatives to rounding, not in every bit: sums are taken in another order. Of one thread.
class LaneEquations {
 public:
  virtual ~LaneEquations() = default;
  /// Whether these equations may be put into a lane: they differ from those there in numbers only.
  [[nodiscard]] virtual bool fits(const EquationsOfMotion& equations) const = 0;
  /// Puts equations that fit into a lane, in the place of those there; they must outlive their calls. May allocate.
  virtual void put(std::size_t lane, const EquationsOfMotion& equations) = 0;
  /// Evaluates the lanes that have a call; null: none. Allocates nothing. \param calls one a lane
  virtual void derivatives(std::span<LaneCall* const> calls) noexcept = 0;
  /// Makes the stages of steps with one table, likewise. Between the stages nothing leaves the lanes but what loads
  /// that are not functions of time alone ask for. What was made ahead is forgotten.
  virtual void steps(std::span<LaneStep* const> calls) noexcept = 0;
  /// Answers a step that follows the last one where `steps` has made it already, with no evaluation; whether it has.
  /// Which steps are made ahead of their call changes no result.
  virtual bool made_ahead(std::size_t lane, LaneStep& call) noexcept = 0;
  /// The same of the energies at the end of the step that the lane was given last. Where it has none yet, they are
  /// found ahead at the same place among the next steps.
  virtual bool made_ahead(std::size_t lane, LaneEnergy& call) noexcept = 0;
  /// Whether these have energies in lanes, which is a matter of each case alone.
  [[nodiscard]] virtual bool has_energies() const = 0;
  /// Finds what Observation::energies tells of a state, likewise.
  virtual void energies(std::span<LaneEnergy* const> calls) noexcept = 0;
};

/// The most lanes that any processor has.
constexpr std::size_t most_lanes = 8;
/// How many lanes this processor has: as many as a vector register holds numbers, four, or eight with AVX-512.
[[gnu::visibility("default")]] std::size_t lane_count() noexcept;

/// Lanes that all begin with these equations; null where they have none (see lane_refusal).
[[gnu::visibility("default")]] std::unique_ptr<LaneEquations> lane_equations(const EquationsOfMotion& equations);

/// Why these equations are evaluated one at a time alone, as "the formulation is strict"; empty where they have lanes.
[[gnu::visibility("default")]] std::string lane_refusal(const EquationsOfMotion& equations);

}  // namespace withy
