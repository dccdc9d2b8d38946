/// \file
/// The loop over the steps of an integration: it lands on discontinuities, renews discrete states, finds the zeros of
/// switching functions and events, and interpolates outputs. Runs, pairs of runs and probes observe it.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/plugin/floating_point.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/event_actions.hpp"
#include "withy/core/simulation/inside_check.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/run_event.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/time_courses.hpp"
#include "withy/core/simulation/zero_watch.hpp"

namespace withy {

/// How stepping ended.
struct SteppingEnd {
  enum class Cause {
    reached,        ///< the end
    event,          ///< an event that stops the run
    stopped,        ///< the observer said so
    failed,         ///< no step can be made: `step` says why
    crowded,        ///< switches or events follow each other again and again without time between them
    unknown_inside  ///< an output within the last step is not finite, where the states at its ends are
  };
  Cause cause = Cause::reached;
  StepResult step;
  std::string reason = {};  ///< of a failure that is no step's: the words of a load
};

/// What watches stepping, and may end it.
class SteppingObserver {
 public:
  SteppingObserver() = default;
  SteppingObserver(const SteppingObserver&) = delete;
  SteppingObserver& operator=(const SteppingObserver&) = delete;
  virtual ~SteppingObserver() = default;
  /// Asked before each step; false ends the stepping at the last accepted state.
  virtual bool before_step(const Stepper& /*stepper*/) { return true; }
  /// A state at a multiple of the output interval, interpolated within the last step. False ends the stepping.
  virtual bool output(const State& state) = 0;
  /// After each accepted step and the outputs within it; `outputs`: there were some. False ends the stepping.
  virtual bool after_step(const Stepper& /*stepper*/, bool /*outputs*/) { return true; }
  /// Zeros of an event's function have been passed at this time. Each is told once, in the order of their times.
  virtual void passed(const EventTime& /*event*/) {}
  /// A load has switched at the zero of a function of its own: its discrete states have changed.
  virtual void switched() {}
  /// At the time of a discontinuity of loads or of SteppingOptions::hand_overs, before the stepper begins anew.
  virtual void landed(const State& /*state*/) {}
  /// Events of the scene have acted: the state has changed from the first to the second, by impulses or otherwise.
  virtual void acted(const State& /*before*/, const State& /*after*/) {}
  /// Discrete states of loads have been renewed or have switched: what follows is not smooth with what was before.
  virtual void jumped() {}
  /// A load or a motion jumps at the present time, as it has declared.
  virtual void restarted() {}
  /// Renews the discrete states that are due at the state's time; for states that are not laid out as the model's.
  virtual void renew(Clocks& clocks, State& state) { clocks.renew(state); }
  /// Why a load has failed at a state, as Renewal::failure.
  virtual std::string failure(const Clocks& clocks, const State& state) { return clocks.failure(state); }
};

struct SteppingOptions {
  double end = 0;                           ///< [s]
  double output = 0.01;                     ///< interval of outputs [s]; they fall on its multiples
  std::span<const RunEvent> events = {};    ///< looked for on the dense output; of `actions` those that they watch
  std::span<const double> hand_overs = {};  ///< times [s] at which the equations change; increasing
  EventActions* actions = nullptr;          ///< what the scene's events do; null: nothing
  /// Over which formulas of the time are looked at at once [s], from the start on and again and again; up to the end,
  /// if it is known: 0.
  double looks_over = 0;
};

/// One integration under way.
class Stepping {
 public:
  /// \param stepper begun at a state whose discrete states are set (see `begun`)
  /// The model, its equations and the events must outlive the object.
  /// \throws std::invalid_argument where the equations are of closed loops and the stepper is no ClosingStepper.
  Stepping(const Model& model, const EquationsOfMotion& equations, std::unique_ptr<Stepper> stepper,
           const SteppingOptions& options);
  /// Steps to the end. Steps land on discontinuities of loads and motions, on the instants of discrete states and on
  /// the end bit by bit. The states at the start and at the end are no outputs.
  /// \throws IntegratorError where the integrator throws, or makes what is no step; PluginError after the step in which
  /// a plugin has changed the processor's arithmetic.
  SteppingEnd run(SteppingObserver& observer);
  /// Moves the end, for `run` to go on. Where nothing jumps at the present end the stepper goes on as it was.
  void move_end(double end) { end_ = end; }
  /// Puts a state of the present time in the place of the present one: inputs have been set.
  void replace(const State& state) { stepper_->jump(state); }
  [[nodiscard]] const Stepper& stepper() const { return *stepper_; }
  [[nodiscard]] const State& state() const { return stepper_->state(); }
  /// Evaluations made by steps alone: those of outputs and events in between do not count.
  [[nodiscard]] std::size_t step_evaluations() const { return step_evaluations_; }
  /// Goes on from a checkpoint's state and the numbers that Stepper::memory gave for it.
  /// \throws std::invalid_argument as Stepper::resume.
  void resume(const State& state, std::span<const double> memory);
  /// Stepper::memory. \throws IntegratorError
  [[nodiscard]] std::vector<double> stepper_memory() const;
  /// What the loop knows beyond the stepper.
  void remember(Memory& memory);

 private:
  using Zero = ZeroWatch::Zero;
  bool to(double limit, bool watching);
  bool after_step();
  void step_to(double limit);
  void check_step(double from, double limit) const;
  [[nodiscard]] bool crawls(double from, double limit);
  void jump_to(const State& state);
  [[nodiscard]] bool sample_is_known() const;
  void check_arithmetic();
  bool act(std::span<const std::size_t> happened);
  bool leap(const std::vector<EventActions::Acted>& acted);
  [[nodiscard]] int direction_of(std::size_t event) const;
  [[nodiscard]] double next_instant() const;
  [[nodiscard]] bool changes_the_run(const Zero& zero) const;
  bool act_on_zeros();
  [[nodiscard]] double end_beyond_kink() const;
  bool cut_at(double time, std::size_t noted);
  void note(const Zero& zero);
  bool renew_clocks();
  void look_ahead();
  bool sound(const State& state);
  bool end(SteppingEnd::Cause cause);
  [[nodiscard]] double coincidence(const Zero& zero) const;

  static constexpr int most_zeros_at_once = 20;

  std::unique_ptr<Stepper> stepper_;
  SteppingObserver* observer_ = nullptr;  ///< of the run under way
  Clocks clocks_;
  std::vector<double> jumps_;  ///< times [s] of discontinuities, increasing
  ZeroWatch zeros_;
  EventActions* actions_;
  OutputTimes times_;
  const Model& model_;
  TimeCourses courses_;  ///< nothing of a stepper whose steps are given
  double start_, looks_over_, looked_until_;
  double end_;
  State sample_;
  State before_;    ///< where the last step began; kept only where zeros are watched
  State acted_on_;  ///< before events have acted
  std::vector<std::size_t> happened_;
  std::vector<Zero> handled_;  ///< zeros of the last step, or those up to where it is cut
  SteppingEnd ended_;
  double last_zero_ = -std::numeric_limits<double>::infinity();  ///< time of the last one that changed the run
  double beyond_kink_ = last_zero_;                              ///< where the step ends that begins at a kink [s]
  int zeros_at_once_ = 0;
  int steps_below_resolution_ = 0;  ///< in a row
  std::size_t shown_;               ///< of the first numbers of y: what outputs tell of motion
  InsideCheck check_inside_;
  std::size_t step_evaluations_ = 0;
  FloatingPointGuard* arithmetic_ = nullptr;  ///< of the run under way
};

}  // namespace withy
