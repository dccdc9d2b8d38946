/// \file
/// The instants of a run at which loads renew their discrete states, by the clock.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/renewal.hpp"

namespace withy {

/// Whether any load switches where a function of the state is zero, or events act.
bool has_switches(const Model& model);

/// The state with all discrete states set for a run of the equations from its time on: those that a run has set already
/// stay, instants up to that time having been.
State begun(const Model& model, const EquationsOfMotion& equations, State state);

/// Renews discrete states by their loads' clocks. Instants that rounding alone tells apart are one: 0.3 and the third
/// multiple of 0.1.
class Clocks {
 public:
  /// The model and its equations must outlive the clocks.
  Clocks(const Model& model, const EquationsOfMotion& equations);
  /// Sets all discrete states for a run from the state's time on, as `begun`.
  void begin(State& state);
  /// Goes on from a state whose instants up to its time have been.
  void go_on_after(double time);
  /// Goes on with the instants from a time [s] on, that at the time itself among them.
  void go_on_with(double time);
  /// The next instant [s] of any clock; infinity where there is none.
  [[nodiscard]] double next() const;
  /// Whether the next instant is at this time [s], or was before it.
  [[nodiscard]] bool due(double time) const;
  /// Renews what is due at the state's time.
  void renew(State& state) { renew(state, renewal_); }
  /// The same, of a state of other equations of the model.
  void renew(State& state, Renewal& renewal);
  /// Renews the states of one load at the zero of a switching function of its own. \returns whether it has switched: a
  /// load with hysteresis passes levels that mean nothing where it stands.
  bool renew(State& state, const LoadSlot& slot, const Crossing& crossing);
  /// As those of Renewal.
  [[nodiscard]] std::string failure(const State& state) const { return renewal_.failure(state); }
  [[nodiscard]] std::string refusal(const State& state) const { return renewal_.refusal(state); }
  void forget() const { renewal_.forget(); }

 private:
  struct Clock {
    LoadSlot slot;
    double period;
    double index;  ///< of the next instant; whole
  };
  /// Sets the clocks to their first instants after `time` [s]; with_time: or at it.
  void set_next(double time, bool with_time);

  const Model& model_;
  std::vector<Clock> clocks_;
  Renewal renewal_;
  std::vector<double> before_;  ///< states of a load that may switch
};

}  // namespace withy
