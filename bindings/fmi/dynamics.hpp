/// \file
/// A scene at one state: its derivatives, outputs, their sensitivities, and its events. What an FMU computes.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/bindings/fmi/variables.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/event_actions.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/core/simulation/zero_watch.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::fmi {

/// What was asked for cannot be had at this state; another state may do: `discard` in both standards.
class Discarded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What an update of discrete states has found.
struct EventUpdate {
  bool again = false;      ///< a switching function has passed zero because of the update itself
  bool terminate = false;  ///< an event of the scene that stops a run
  double next = 0;         ///< [s]; infinity where no instant is known beforehand
};

/// Of one thread. Quaternions in the state may be of any length: what is computed is that of the unit quaternions.
class Dynamics {
 public:
  /// Stands at the scene's initial state at time t [s].
  Dynamics(std::shared_ptr<const study::Prepared> prepared, double t);
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  [[nodiscard]] const Model& model() const { return prepared_->model(); }
  [[nodiscard]] const study::Prepared& prepared() const { return *prepared_; }
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] std::size_t states() const { return states_; }
  [[nodiscard]] double time() const { return state_.time; }
  [[nodiscard]] std::span<const double> moving() const { return std::span(state_.y).first(states_); }
  /// Whether a motion prescribes the state of this index.
  [[nodiscard]] bool driven(std::size_t state) const { return driven_[state]; }

  /// The scene's initial state at this time: what motions prescribe is where it now is.
  [[nodiscard]] State initial() const;

  void set_time(double t);
  void set_moving(std::span<const double> y);
  void set_state(std::size_t index, double value);
  /// Begins states of loads, those of these indices, as the loads say where all else stands as it does.
  void begin_loads(std::span<const std::size_t> states);
  /// Goes to a state of a simulation, which deals with what jumps by itself.
  void show(const State& state);
  [[nodiscard]] double input(std::size_t load) const;
  /// Whether an input is what a motion reaches at the end of a step: it cannot be set at once.
  [[nodiscard]] bool is_reached(std::size_t load) const;
  /// Holds from now on; nothing of what is reached.
  void set_input(std::size_t load, double value);

  /// ẏ of the moving states. \throws Discarded where there is none.
  std::span<const double> derivatives();
  /// A number of the tables. \throws Discarded where it is not finite; others may be none.
  double output(std::size_t column);
  /// Derivatives of ẏ and of chosen columns along a direction of states and inputs (empty: none of them moves).
  /// Those of ẏ along states are exact, along inputs too where ẏ is affine in them; else those along inputs are central
  /// differences of eighth order, as those of columns are.
  /// \param inputs loads, and `along_inputs` their rates of change
  void sensitivity(std::span<const double> along_states, std::span<const std::size_t> inputs,
                   std::span<const double> along_inputs, std::span<double> derivatives,
                   std::span<const std::size_t> columns, std::span<double> values);

  [[nodiscard]] std::size_t indicators() const { return signs_.size(); }
  /// Switching functions of the loads, then the scene's events, each shifted such that its zero lies a rounding beyond
  /// the function's own; until the next call.
  std::span<const double> event_indicators();
  double indicator(std::size_t index) { return event_indicators()[index]; }
  /// Renews the discrete states that are due at this time or whose switching functions have changed their signs.
  EventUpdate update_discrete();
  /// The state with the discrete states of loads as before a start; inputs stay.
  [[nodiscard]] State start() const;
  /// Begins: discrete states are set for a start at this time. \returns the next instant
  EventUpdate begin();

  void remember(Memory& memory);

 private:
  const State& seen();
  void changed();
  double next_instant();
  Evaluation evaluate(const State& state);
  void differences(std::span<const double> along_states, std::span<const std::size_t> inputs,
                   std::span<const double> along_inputs, std::span<const std::size_t> columns,
                   std::span<double> values);
  [[nodiscard]] std::vector<double> seen_along(std::span<const double> along_states) const;
  State moved(double h, std::span<const double> along_states, std::span<const std::size_t> inputs,
              std::span<const double> along_inputs);
  void add_along_states(std::span<const double> along, std::span<double> derivatives);
  void add_along_inputs(std::span<const std::size_t> inputs, std::span<const double> along_inputs,
                        std::span<double> derivatives);
  bool switch_where_passed(EventUpdate& update);
  void happen(std::span<const std::size_t> events, EventUpdate& update);
  void happen_where_due(EventUpdate& update);
  [[nodiscard]] bool is_over(std::size_t indicator) const;
  void read_switches();

  std::shared_ptr<const study::Prepared> prepared_;
  const EquationsOfMotion& equations_;
  std::size_t states_;
  bool quaternions_;
  State state_, seen_;
  Work work_;
  ResultColumns table_;
  std::vector<bool> driven_;
  std::vector<double> y_dot_, jacobian_;
  bool seen_is_now_ = false, derivatives_are_now_ = false, jacobian_is_now_ = false;
  const std::vector<double>* row_ = nullptr;  ///< of the table at the present state; null: not found yet
  Clocks clocks_;
  EventActions events_;
  std::vector<std::size_t> looked_for_;  ///< of its events those that watch a number, which are indicators
  double event_due_ = 0;                 ///< the next time [s] at which an event happens by itself
  ZeroWatch zeros_;
  std::vector<double> jumps_;  ///< times [s] of discontinuities, increasing
  double jump_ = 0;            ///< the next one [s]; what jumps there does so when discrete states are updated
  std::vector<int> signs_;     ///< of the indicators when discrete states were updated last
  std::vector<double> values_;
};

}  // namespace withy::fmi
