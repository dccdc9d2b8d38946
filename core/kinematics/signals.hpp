/// \file
/// What continuous controllers measure: numbers of a state by their names, found from positions and speeds alone, and
/// from accelerations where these are known.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/kinematics/frame_paths.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// Chosen numbers of a model: columns of hinges (`shoulder` [rad], `shoulder.rate` [rad/s]), numbers of sensors that
/// need no efforts or energies (`imu.z`), and what other loads give (`servo`, of several numbers
/// `servo.0`). Immutable; the caller owns the scratch space.
class [[gnu::visibility("default")]] Signals {
 public:
  /// An element of State::y.
  struct Element {
    bool rate = false;      ///< a speed, else a position
    std::size_t index = 0;  ///< among those
  };

  /// The sensors are Model::measured(), the loads those that the model has.
  /// \param terms of the formulation; frames move by its strain kinematics without truncation, as outputs show them
  /// \throws std::invalid_argument where there is no such number, or where it depends on efforts or energies.
  Signals(const Model& model, const Terms& terms, std::vector<std::string> names);
  Signals(Signals &&) noexcept;
  ~Signals();

  [[nodiscard]] std::size_t size() const { return sources_.size(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Doubles of scratch space that `read` needs.
  [[nodiscard]] std::size_t scratch() const { return scratch_; }
  /// The element of State::y that a signal is; nothing where it is another number.
  [[nodiscard]] std::optional<Element> element(std::size_t signal) const { return sources_[signal].element; }
  /// Whether any is given by another load: a view of the whole state is then needed.
  [[nodiscard]] bool of_loads() const;
  /// Whether a signal depends on accelerations, and so on the efforts of the same instant.
  [[nodiscard]] bool needs_accelerations(std::size_t signal) const;
  /// Whether any depends on the place of a frame.
  [[nodiscard]] bool of_frames() const { return paths_ != nullptr; }
  /// Sets the numbers, one a name, at the state of `view`, with its scratch space. Where the view has no accelerations,
  /// those that need them mean nothing, but are finite.
  void read(const LoadView& view, std::span<double> values) const noexcept;

 private:
  class [[gnu::visibility("hidden")]] Seen;
  struct Source {
    std::optional<Element> element;
    std::size_t number = 0;                 ///< of all sensors' numbers, where it is one
    std::shared_ptr<const BoundLoad> load;  ///< that gives it, where one does
    std::size_t index = 0;                  ///< of that load in Model::loads()
    std::size_t output = 0;                 ///< among what it gives
    LoadSlot continuous = {};               ///< of its states
    bool accelerated = false;               ///< of a sensor's number: whether it depends on accelerations
  };
  /// A sensor that is read, with the place of its numbers.
  struct Reading {
    std::shared_ptr<const BoundSensor> sensor;
    std::size_t first = 0, count = 0;
  };
  /// Where accelerations and efforts are not known: what stands for them.
  struct Unknown {
    double acceleration = 0, effort = 0;
  };

  static Source find(const Model& model, const std::string& name);
  void choose_readings(const Model& model, const Terms& terms);
  /// Refuses numbers that depend on efforts or energies, and marks those that depend on accelerations.
  void sort_out(const Model& model);
  void read_sensors(const LoadView& view, Unknown unknown, std::vector<FrameIndex>* asked) const noexcept;
  /// Accelerations of the frames in the scratch space, J u̇ + J̇ u, at the state that the work memory has.
  void accelerate(const LoadView& view, std::byte* work) const noexcept;
  /// The numbers of the sources at a state about the reference.
  [[nodiscard]] std::vector<double> probe(const Model& model, Unknown unknown, std::vector<FrameIndex>* asked) const;
  void lay_out();
  [[nodiscard]] std::size_t paths_doubles() const;  ///< of their work memory, with room to align it

  std::vector<std::string> names_;
  std::vector<Source> sources_;
  std::vector<Reading> readings_;
  std::size_t numbers_ = 0;             ///< of all measured sensors
  std::shared_ptr<const Model> model_;  ///< that `paths_` refer to
  ActingFields fields_;                 ///< of that model
  std::vector<FrameIndex> frames_;
  std::unique_ptr<const FramePaths> paths_;  ///< null: no frame is asked for
  std::vector<double> zeros_;                ///< one a speed
  bool accelerates_ = false;                 ///< accelerations of frames are needed
  std::size_t own_ = 0;                      ///< doubles for sensors
  std::size_t scratch_ = 0;
};

}  // namespace withy
