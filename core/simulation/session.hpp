/// \file
/// A simulation that its host steps from time to time: it sets inputs before a step and reads the state after it.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/simulation/creep_watch.hpp"
#include "withy/core/simulation/loop_watch.hpp"
#include "withy/core/simulation/monitor.hpp"
#include "withy/core/simulation/stepping.hpp"
#include "withy/core/simulation/stop.hpp"

namespace withy {

struct SessionOptions {
  double deflection_limit = 1.0;      ///< a deflection past this many lengths of its body is divergence
  std::vector<RunEvent> events;       ///< looked for on the dense output
  std::function<bool()> interrupted;  ///< asked between integration steps
  bool own_energy = false;            ///< as RunOptions::own_energy
  double looks_over = 0;              ///< as SteppingOptions::looks_over; 0: formulas are not looked at ahead
};

/// How a call of Session::advance ended.
struct SessionEnd {
  RunStatus status = RunStatus::completed;
  std::string message;   ///< the physical reason of a bad end; else empty
  bool reached = false;  ///< the time asked for; else an event halted it before, or the status says why
  bool halted = false;   ///< an event that stops runs has halted it, maybe at the time asked for
};

/// One simulation, of one thread. Steps that go well allocate nothing.
class Session final : private SteppingObserver {
 public:
  /// The model, the equations and the integrator must outlive the object.
  Session(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator, const State& initial,
          SessionOptions options);

  [[nodiscard]] const State& state() const { return loop_.state(); }
  [[nodiscard]] const Stepper& stepper() const { return loop_.stepper(); }
  /// The value of an input [N m, N]: what it was set to last, or else its value now.
  /// \param load index in Model::loads() of a load that has an InputPort
  [[nodiscard]] double input(std::size_t load) const;
  /// Sets an input for the steps from now on. \throws std::invalid_argument where the value is not finite.
  void set_input(std::size_t load, double value);

  /// Integrates to the time t [s] and lands on it bit by bit; nothing jumps there because of that. Ends before it where
  /// it cannot go on, where it is interrupted, or with `halt` at an event that stops runs. The state is then the last
  /// accepted one.
  /// After a bad end it stays there and gives that end again.
  /// \throws std::invalid_argument where t lies before the present time or is not finite.
  SessionEnd advance(double t, bool halt);
  /// The bad end that it has come to; nothing where it may go on.
  [[nodiscard]] const std::optional<SessionEnd>& ended() const { return ended_; }
  /// The events of the last `advance`, in their order.
  [[nodiscard]] const std::vector<EventTime>& events() const { return events_; }

  /// The next step begins with derivatives computed anew: what it was restored from was of other equations.
  void begin_step_anew() { loop_.replace(state()); }

  /// Everything that the steps to come depend on. Another session of the same scene may restore it.
  /// \throws std::logic_error after a bad end
  [[nodiscard]] Checkpoint snapshot();
  /// Goes on from a snapshot, bit by bit as the simulation did from there with the same inputs.
  /// \throws std::invalid_argument where it is not one of such a simulation; this one is then as it was.
  void restore(const Checkpoint& snapshot);

 private:
  /// What the host has asked of an input.
  struct Setting {
    std::size_t load;
    bool waiting = false;  ///< `value` is not in the state yet
    double value = 0;
    double reached = -std::numeric_limits<double>::infinity();  ///< time at which its line ends, or ended [s]
    bool rests = false;  ///< at its end the line is ended: a position or a rate, after which there is no acceleration
  };
  bool before_step(const Stepper& stepper) override;
  bool output(const State& state) override;
  bool after_step(const Stepper& stepper, bool outputs) override;
  void passed(const EventTime& event) override;
  void acted(const State& before, const State& after) override;
  void apply_settings(double t);
  bool end_lines();
  [[nodiscard]] SessionEnd go(double t);
  [[nodiscard]] SessionEnd bad_end(Stop stop);
  void remember(Memory& memory);
  void go_on_from(const Checkpoint& snapshot);
  [[nodiscard]] const Setting& setting(std::size_t load) const;

  const Model& model_;
  const EquationsOfMotion& equations_;
  SessionOptions options_;
  State initial_;
  RunSummary summary_;  ///< what the monitor notes
  EventActions actions_;
  Stepping loop_;
  Monitor monitor_;
  LoopWatch loops_;
  LaterHalf halves_;
  CreepWatch creep_;
  std::vector<Setting> settings_;
  State with_inputs_;
  std::vector<EventTime> events_;
  Stop stop_;
  bool halts_ = false;  ///< events that stop runs halt the present advance
  std::optional<SessionEnd> ended_;
};

}  // namespace withy
