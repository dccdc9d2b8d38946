/// \file
/// Does what the events of a scene ask for, in one run: finds what is due, locks hinges by impulses, changes loads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/renewal.hpp"
#include "withy/core/simulation/run_event.hpp"
#include "withy/core/simulation/sensor_reader.hpp"

namespace withy {

/// The events of one run. Of one thread.
class EventActions {
 public:
  /// \param plain functions whose zeros the run looks for beside. The model and the equations must outlive the object.
  EventActions(const Model& model, const EquationsOfMotion& equations, std::span<const RunEvent> plain);
  EventActions(const EventActions&) = delete;
  EventActions& operator=(const EventActions&) = delete;

  /// The plain events, then one for each event of the plan: its function has a zero where it happens.
  [[nodiscard]] std::span<const RunEvent> watched() const { return watched_; }
  /// Whether an event of `watched` is one of the plan.
  [[nodiscard]] bool acts(std::size_t watched) const { return watched >= plain_; }
  /// Whether one of the plan cannot happen any more, or has happened and waits to act.
  [[nodiscard]] bool over(std::size_t watched, const State& state) const;
  /// The next time [s] at or after that of the state at which an event is due; infinity where none is.
  [[nodiscard]] double next(const State& state) const;

  /// An event that has acted.
  struct Acted {
    std::size_t watched = 0;  ///< its index in `watched`
    double moved = 0;         ///< by what its own actions have changed the value of its function, if it looks for more
  };
  /// What `act` has done.
  struct Done {
    std::vector<Acted> acted;  ///< in their order
    bool stops = false;        ///< one of them ends the run
    bool crowded = false;      ///< events go round in a circle, without time between them
    Evaluation evaluation;     ///< of the impulses; not ok: there are none, the mass matrix cannot be solved
  };
  /// Notes that the events of these indices in `watched` happen at the state and does all that is due then: first in
  /// the order of the file, then what follows from it.
  const Done& act(State& state, std::span<const std::size_t> happened);

 private:
  [[nodiscard]] double value(const ActingEvent& event, double t, std::span<const double> y);
  [[nodiscard]] bool over_at(std::size_t event, std::span<const double> y) const;
  bool perform(std::size_t event, State& state);
  bool perform_and_measure(std::size_t event, State& state, double& moved);
  void change_form(State& state, const EventAction& action);
  Evaluation settle(State& state);
  void respond(std::span<const double> y, std::span<const double> driven, std::span<const double> efforts,
               std::span<double> response);

  const Model& model_;
  const EquationsOfMotion& equations_;
  EventBook book_;
  std::size_t plain_ = 0;
  std::vector<RunEvent> watched_;
  std::unique_ptr<SensorReader> reader_;
  std::vector<double> readings_;
  State read_;
  bool readable_ = false;  ///< `read_` has finite accelerations
  Work work_;
  std::unique_ptr<Observation> seen_;
  std::unique_ptr<Renewal> renewal_;
  std::vector<double> at_rest_, base_;
  Evaluation responded_;
  Done done_;
};

}  // namespace withy
