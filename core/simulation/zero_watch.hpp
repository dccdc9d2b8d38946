/// \file
/// Where functions pass through zero within steps: where loads switch, where events happen, where efforts have kinks.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/kinks.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/run_event.hpp"
#include "withy/core/simulation/step_parts.hpp"

namespace withy {

/// Watches functions for zeros within accepted steps: switching functions of loads, events, and kinks of loads, of
/// which those count that a step has passed and come back from.
class ZeroWatch {
 public:
  /// A zero that a function has passed.
  struct Zero {
    double time = 0;           ///< [s]
    std::size_t function = 0;  ///< switching functions in the loads' order, then the events, then kinks
    int direction = 0;         ///< +1: from below, −1: from above
  };
  /// Watches the switching functions of the model's loads and `events`, from a state on. Both must outlive the watch.
  /// \param end of the run [s]
  ZeroWatch(const Model& model, std::span<const RunEvent> events, const State& start,
            double end = std::numeric_limits<double>::infinity(), bool kinks = false);
  [[nodiscard]] bool empty() const { return signs_.empty(); }

  /// The zeros passed in the stepper's last step, which began at the state `before`, on its dense output, in their
  /// order; not much further than to the first that `cuts` the step, after which it is made again.
  const std::vector<Zero>& find(const Stepper& stepper, const State& before,
                                const std::function<bool(const Zero&)>& cuts);
  /// Says that all zeros that `find` has given have been dealt with.
  void pass() { signs_ = before_; }
  /// Whether a zero changes the run: a load switches or has a kink there, or an event stops it.
  [[nodiscard]] bool acts(const Zero& zero) const {
    return zero.function < switches_ || is_kink(zero.function) || event(zero.function).stops;
  }
  [[nodiscard]] bool is_kink(std::size_t function) const { return function >= switches_ + events_.size(); }
  /// At a state that a step from `before` was made to end at because of one of the zeros `known`: the zeros of others
  /// passed with it. The functions of `known` have passed, whatever sign rounding leaves them here.
  const std::vector<Zero>& land(const State& before, const State& state, std::span<const Zero> known);
  /// At a state that events have changed: the zeros passed by that. Functions that `land` saw pass have, until an event
  /// moves them by more than their zeros are known to.
  const std::vector<Zero>& leap(const State& state);
  /// Whether a zero that `leap` has given would not be one, but for rounding, had the value of its function not changed
  /// by `moved`.
  [[nodiscard]] bool is_due_to(double moved, const Zero& zero) const;
  /// Takes the signs at a state where discrete states have changed.
  void begin_at(const State& state);

  /// The load and the index within it of a switching function; nothing for an event of the caller.
  [[nodiscard]] std::optional<std::pair<LoadSlot, int>> switching(std::size_t function) const;
  /// The event of the caller that a function is.
  [[nodiscard]] const RunEvent& event(std::size_t function) const { return events_[function - switches_]; }
  /// Its index among the events.
  [[nodiscard]] std::size_t index(const Zero& zero) const { return zero.function - switches_; }
  void remember(Memory& memory) {
    memory(signs_);
    for (double& unsure : unsure_) memory(unsure);
    for (double& landed : landed_) memory(landed);
  }

 private:
  void evaluate(double t, std::span<const double> y, std::span<double> values) const;
  void leave_out_what_does_not_matter(const State& start, double end);
  /// Functions at a time within the last step.
  struct Row {
    double time = 0;
    std::vector<double> values;
  };
  /// The motion within the last step.
  struct Course {
    const Stepper& stepper;
    const State& before;
    /// By the states at its ends alone, not by what the stepper interpolates: of that, evaluations that nothing checks
    /// may be a part, and beyond a kink they bend the motion away from it.
    bool by_ends;
  };
  void look_at(const Course& course, double t);
  /// Sets the state inside: coordinates that are integrals of a rate by the cubic through both ends with both rates.
  void between(const State& before, const State& after, double t);
  /// Whether functions of coordinates alone pass zero in a step, or may and come back: where the tangent at one of the
  /// ends does. What bends one way lies on one side of its tangents. Leaves the signs at the end.
  [[nodiscard]] bool may_pass(const State& before, const State& after);
  /// Takes up the zeros of a step of the functions from `first` on, from `looks` looks into it.
  void look_through(const Course& course, std::size_t first, std::size_t looks,
                    const std::function<bool(const Zero&)>& cuts);
  void take(const Course& course, double t);
  /// The end of the bracket [a, b] in which a function passes zero, where it has the sign it has at b.
  [[nodiscard]] double zero_between(const Course& course, std::size_t f, double a, double b, double value_at_b);
  /// Which functions are not known to have left their zeros at the end of a step either.
  void doubt_what_stays_near(const State& after);
  /// Takes up the zeros of a function between a row and the next.
  void cross(const Course& course, std::size_t f, const Row& begin, const Row& end);
  /// Takes the sign, at the last row, of a function that began the step near its zero, and the zero that it has passed
  /// with that.
  void leave(std::size_t f, double from);
  /// As `cross` where it has one sign at both rows, and the parabola through three rows has another in between.
  void cross_there_and_back(const Course& course, std::size_t f, std::size_t interval);
  /// Whether a function jumps past its value at the time of the state that `land` looks at.
  /// \param length of the step that has come there [s]
  /// \param instant from the time of `just_before_` to that of `landed_` [s]
  [[nodiscard]] bool has_jumped(std::size_t function, double length, double instant) const;
  /// Whether a function that has this sign now is to be noticed.
  [[nodiscard]] bool noticed(std::size_t function, int direction) const;
  [[nodiscard]] bool looks(std::size_t function, std::span<const double> y) const;

  const Model& model_;
  std::span<const RunEvent> events_;
  std::size_t switches_ = 0;
  std::vector<LoadSlot> slots_;  ///< of loads with switching functions
  std::vector<const Kinks*> kinks_;
  std::vector<int> signs_;  ///< −1, 0, +1 at the last accepted state
  std::vector<int> before_;
  std::vector<int> start_signs_;  ///< `signs_` at the start of the step that `find` has looked at
  std::vector<double> values_, ends_;
  std::array<Row, 3> rows_;          ///< those looked at last, in the order of their times
  std::vector<double> landed_;       ///< values at the state that `land` has seen
  std::vector<double> just_before_;  ///< the same at the time before, to rounding
  std::vector<double> unsure_;       ///< how far from zero these may be of functions that passed there; else below zero
  std::vector<double> near_;    ///< the same of those that begin the step so near: their signs are seen a little later
  std::vector<int> end_signs_;  ///< at the end of the step
  std::vector<Zero> zeros_;
  State inside_;
  std::optional<StepParts> parts_;  ///< nothing where nothing is watched
  struct Moving {
    std::size_t position, rate;  ///< places in y of a coordinate and of its derivative
  };
  static std::vector<Moving> moving_coordinates(const Model& model);
  std::vector<Moving> moving_;
};

}  // namespace withy
