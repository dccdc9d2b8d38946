/// \file
/// A simulation that its host steps: inputs before a step, outputs after it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "withy/host/scene.hpp"
#include "withy/host/stopped.hpp"

namespace withy::host {

/// An event of the scene that a step has passed.
struct Event {
  std::string name;
  double time = 0;    ///< [s]
  int direction = 0;  ///< +1: from below, −1: from above
};

/// Everything that the steps to come depend on. Copies are cheap; threads may share one. An empty one, which no
/// simulation has made, throws std::invalid_argument where it is used.
class Snapshot {
 public:
  [[nodiscard]] double time() const;  ///< [s]
  /// As a list of numbers, to be kept; for simulations of the same scene by the same build. Some may be infinite.
  [[nodiscard]] std::vector<double> numbers() const;
  /// \throws std::invalid_argument where they are no snapshot, or not all of one bit by bit.
  static Snapshot of_numbers(std::span<const double> numbers);

 private:
  friend class Simulation;
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// One simulation, of one thread at a time. The same scene, inputs and step times give the same bits, whatever other
/// threads do.
class Simulation {
 public:
  /// Stands at the initial state. \throws as Scene::check; study::InputError where the formulation is `auto`.
  explicit Simulation(const Scene& scene, std::function<bool()> interrupted = {});
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  [[nodiscard]] double time() const;  ///< [s]
  /// Loads of type `input`, by their names [N m, N].
  [[nodiscard]] const std::vector<Port>& inputs() const;
  /// The columns of results.csv.
  [[nodiscard]] const std::vector<Port>& outputs() const;

  /// For loops. \throws std::out_of_range with the nearest name where there is none of this; so do all that take one.
  [[nodiscard]] std::size_t input_index(std::string_view name) const;
  [[nodiscard]] std::size_t output_index(std::string_view name) const;

  /// The value now or, from `set_input` to the next step, the value set: with `hold: linear`, where `advance_to` has
  /// halted inside a step, how far the line has come. An index past the end is std::out_of_range.
  [[nodiscard]] double input(std::size_t index) const;
  [[nodiscard]] double input(std::string_view name) const;
  /// Acts in the steps from now on: at once, or with `hold: linear` reached at the end of the next step.
  /// \throws std::invalid_argument where it is not finite.
  void set_input(std::size_t index, double value);
  void set_input(std::string_view name, double value);
  /// Of the present state.
  [[nodiscard]] double output(std::size_t index) const;
  [[nodiscard]] double output(std::string_view name) const;
  /// All of them, until the next step.
  [[nodiscard]] std::span<const double> output_values() const;

  /// Integrates to the time t [s] and lands on it bit by bit; events on the way are passed, those that stop a run too.
  /// \throws SimulationStopped where it cannot go on, and again with the same reason until `restore`, or is
  /// interrupted: it may then go on. std::invalid_argument where t lies before the present time; SceneError where the
  /// integrator's plugin fails, after which nothing can be trusted.
  void step(double t);
  /// The same, but halts where an event that stops a run comes first; at one that does nothing else each time it
  /// happens. \returns whether none did: false also of one at t itself
  bool advance_to(double t);
  /// The events of the last step, in their order.
  [[nodiscard]] const std::vector<Event>& events() const;

  /// \throws SimulationStopped, as `step` did, where it cannot go on: nothing goes on from there.
  [[nodiscard]] Snapshot snapshot() const;
  /// Goes on from there bit by bit as the simulation did that made it, with the same inputs and times. A simulation
  /// that was stopped goes on too. \throws std::invalid_argument where it is of another scene: one whose values or
  /// files differ in more than `name`, `time`, `outputs` and `initial`; or of another build. Nothing changes then.
  void restore(const Snapshot& snapshot);
  /// The present state as JSON, in the form that `initial` of a scene and `withy eval --state` read.
  [[nodiscard]] std::string state() const;
  /// Evaluations of the equations of motion so far.
  [[nodiscard]] std::size_t evaluations() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace withy::host
