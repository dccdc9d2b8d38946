/// \file
/// Events that act: what is done at instants of a run, and the discrete states that know what has been done.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// One thing that an event does.
struct EventAction {
  enum class Kind {
    lock,    ///< the hinge's rates vanish, by impulses, and stay zero
    unlock,  ///< the hinge is free again
    form     ///< the load takes this form (SwitchedLoad)
  };
  Kind kind = Kind::lock;
  std::size_t index = 0;  ///< of the hinge or the load
  double form = 0;
  bool releases = false;  ///< what is unlocked is a weld to the scene, and held until then
};

/// An event of a scene.
struct ActingEvent {
  /// When it happens: a number passes a value, at a time, or when another event has acted.
  enum class When { passes, at, after };
  std::string name;
  When when = When::passes;
  int element = -1;        ///< of State::y that passes `value`; −1: a sensor's number does
  std::size_t column = 0;  ///< that number, among those of EventPlan::sensors
  double value = 0;
  int direction = 0;      ///< +1: from below alone, −1: from above alone
  double time = 0;        ///< [s], of When::at
  std::size_t after = 0;  ///< index of the other event
  double delay = 0;       ///< [s], from when it happens to when it acts
  bool repeats = false;   ///< every time; else once
  bool stops = false;     ///< the run ends there, completed
  std::vector<EventAction> actions;

  /// The hinges, increasing, that are locked once it has acted where `locked` were, increasing.
  [[nodiscard]] std::vector<std::size_t> leaves_locked(std::vector<std::size_t> locked) const;
};

/// All events of a scene that act.
struct EventPlan {
  std::vector<ActingEvent> events;
  std::vector<SensorNode> sensors;  ///< up to the last one whose numbers events watch; bound to the model
  /// The sets of hinges, each increasing, that events can have locked; the first is empty.
  std::vector<std::vector<std::size_t>> configurations;
  int start = 0;  ///< index of the configuration in which a motion begins

  static constexpr std::size_t most_configurations = 256;
  /// Fills `configurations` with all that the events' actions lead to from these.
  /// \throws std::invalid_argument where there are more than `most_configurations`.
  void find_configurations(std::vector<std::vector<std::size_t>> from);
  /// Index of a set of locked hinges, increasing; −1 where no event leads to it.
  [[nodiscard]] int configuration(const std::vector<std::size_t>& locked) const;
};

/// The discrete states of a model's events, as a load that gives no effort: the configuration, then five numbers an
/// event.
class EventStates final : public EffortlessLoad, private DiscretePart {
 public:
  explicit EventStates(std::shared_ptr<const EventPlan> plan) : plan_(std::move(plan)) {}
  [[nodiscard]] const EventPlan& plan() const { return *plan_; }

  using EffortlessLoad::add;
  const DiscretePart* discrete() const override { return this; }

 private:
  std::size_t states() const override;
  void renew(double, std::span<const double>, std::span<const double>, const Crossing&, std::span<double>,
             std::span<double>) const noexcept override {}
  void add(double, std::span<const double>, std::span<double>) const noexcept override {}

  std::shared_ptr<const EventPlan> plan_;
};

/// What the numbers of an event in State::y mean.
struct EventNumbers {
  static constexpr std::size_t count = 5;
  double happened = 0;  ///< how often it has acted
  double waiting = 0;   ///< 1: it will act at `due`
  double due = 0;       ///< [s]
  double last = 0;      ///< time at which it last acted [s]
  double loss = 0;      ///< kinetic energy that its impulses have taken, all together [J]
};

/// The events of a model, to read and write what a State knows of them. The model must outlive it.
class EventBook {
 public:
  explicit EventBook(const Model& model);
  /// Whether there are any; else nothing below may be asked.
  [[nodiscard]] bool any() const { return states_ != nullptr; }
  [[nodiscard]] const EventPlan& plan() const { return states_->plan(); }
  /// Index in State::y of the configuration.
  [[nodiscard]] std::size_t place() const { return first_; }
  [[nodiscard]] const std::vector<std::size_t>& locked(std::span<const double> y) const;
  /// \throws std::logic_error where the plan has no configuration of this index.
  void set_configuration(std::span<double> y, int configuration) const;
  [[nodiscard]] EventNumbers numbers(std::span<const double> y, std::size_t event) const;
  void set_numbers(std::span<double> y, std::size_t event, const EventNumbers& numbers) const;
  /// Sets what has been done to nothing; events at a time wait for it.
  void begin(std::span<double> y) const;

 private:
  const EventStates* states_ = nullptr;
  std::size_t first_ = 0;
};

/// Hinges that events have locked at a state; none where there are no events.
std::vector<std::size_t> locked_hinges(const Model& model, const State& state);

/// Adds events to a model, behind its loads. For builders of a model, before it is shared.
void add_events(Model& model, EventPlan plan);
/// Name of the load that holds the events' states; no load of a scene can have it.
inline constexpr const char* name_of_event_states = "(events)";

}  // namespace withy
