/// \file
/// The interface of sensors: the outputs that a scene names.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/load.hpp"

namespace withy {

class Model;

/// A place along a slender body, where its inner forces are asked for.
struct SectionPlace {
  int body = 0;  ///< index in Model::bodies()
  double x = 0;  ///< coordinate along the body [m]
};

/// What is inside a slender body, in the axes of a section and about its place on the body's axis.
struct SectionLoad {
  Wrench inner;                         ///< what the part before the section exerts on all that is beyond it
  Vector3 curvature = Vector3::Zero();  ///< κ [1/m]: twist rate, then the two curvatures
  Vector3 elastic = Vector3::Zero();    ///< the moment that stiffness makes of κ, in the sense of `inner` [N m]
};

/// Energies and momenta of one body.
struct BodyEnergies {
  double kinetic = 0, strain = 0;     ///< [J]
  double weight = 0;                  ///< potential energy of its weight, measured from the world origin [J]
  Vector3 linear = Vector3::Zero();   ///< momentum, world axes [kg m/s]
  Vector3 angular = Vector3::Zero();  ///< about the world origin, world axes [kg m²/s]
};

/// Accelerations of a frame, world axes.
struct FrameAcceleration {
  Vector3 angular = Vector3::Zero();  ///< [rad/s²]
  Vector3 linear = Vector3::Zero();   ///< of its origin [m/s²]
};

/// A state as sensors see it. What is asked for is found then and kept until the next state, each in time proportional
/// to the number of bodies at most; frames move by their bodies' strain kinematics without truncation. Allocates
/// nothing once made; of one thread. Indices that the model has not, of frames, loads, hinges, bodies or sections, give
/// NaN; the sensors of a scene are refused where they ask for one at its start.
class SensedState {
 public:
  virtual ~SensedState() = default;
  /// Goes to a state, which must stay; all else tells of it until the next. False where its accelerations cannot be
  /// found: what depends on them then has no meaning.
  virtual bool observe(const State& state) noexcept = 0;
  [[nodiscard]] virtual const Layout& layout() const noexcept = 0;
  [[nodiscard]] virtual double time() const noexcept = 0;  ///< [s]
  /// As in State::y, whole.
  [[nodiscard]] virtual std::span<const double> y() const noexcept = 0;
  /// Of all speeds [rad/s², m/s²].
  [[nodiscard]] virtual std::span<const double> accelerations() noexcept = 0;
  /// Acceleration of gravity [m/s²], world axes.
  [[nodiscard]] virtual Vector3 gravity() const noexcept = 0;
  /// Motion of a frame, and its accelerations; the body −1 is the world.
  [[nodiscard]] virtual FrameMotion motion(FrameIndex frame) noexcept = 0;
  [[nodiscard]] virtual FrameAcceleration acceleration(FrameIndex frame) noexcept = 0;
  /// Efforts [N m, N] on all speeds of a load (index in Model::loads()) or, −1, of all; until the next call.
  [[nodiscard]] virtual std::span<const double> load_efforts(int load) noexcept = 0;
  /// Efforts [N m, N] of the motions, on all speeds.
  [[nodiscard]] virtual std::span<const double> motion_efforts() noexcept = 0;
  /// What the parent exerts on the child through a hinge, efforts of loads and motions there included: about the
  /// origin of M, in the axes of F. In a truncated formulation it is what the formulation's own equations ask for in
  /// the place of the hinge, were all six speeds there free (docs/outputs.md, "Reactions").
  [[nodiscard]] virtual Wrench reaction(int hinge) noexcept = 0;
  /// At a section that make_sensed_state was told of, by its index there; truncated as a reaction.
  [[nodiscard]] virtual SectionLoad section(std::size_t index) noexcept = 0;
  /// Of a body of the model, as those of the whole.
  [[nodiscard]] virtual BodyEnergies energies(int body) noexcept = 0;
  [[nodiscard]] virtual const Energies& energies() noexcept = 0;
};

/// A number that a sensor gives: `output.component[unit]`, or `output[unit]` where it has one number alone.
struct SensorColumn {
  std::string component;  ///< as "x"; may be empty
  std::string unit;       ///< SI; "1" where there is none
};

/// What a sensor is read with, beside the state.
struct SensorInputs {
  std::size_t first_section = 0;   ///< index that the state has for the first of the sensor's sections
  std::span<const double> before;  ///< numbers of the sensors before it, one after the other
};

/// A sensor bound to one model. Immutable; threads share it.
class BoundSensor {
 public:
  virtual ~BoundSensor() = default;
  /// At least one; no two have the same component.
  [[nodiscard]] virtual std::vector<SensorColumn> columns() const = 0;
  /// Sections whose inner forces it asks for.
  [[nodiscard]] virtual std::vector<SectionPlace> sections() const { return {}; }
  /// Sets one number a column from a state; all are finite where the state is. Allocates nothing.
  virtual void read(SensedState& state, const SensorInputs& inputs, std::span<double> values) const noexcept = 0;
};

/// A sensor of a scene, by its name.
struct SensorNode {
  std::string name;
  std::shared_ptr<const BoundSensor> sensor;
};

/// A sensor as the scene states it.
class Sensor {
 public:
  virtual ~Sensor() = default;
  /// \param before the scene's sensors that stand before it, whose numbers it is read with
  /// \throws std::invalid_argument where the sensor does not fit the model; the text says why.
  [[nodiscard]] virtual std::unique_ptr<BoundSensor> bind(const Model& model,
                                                          std::span<const SensorNode> before) const = 0;
};

}  // namespace withy
