/// \file
/// The interface of loads.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/state.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

class Model;
struct Terms;

/// A frame of a body of a model.
struct FrameIndex {
  int body = 0;   ///< index in Model::bodies()
  int frame = 0;  ///< index among the body's frames
};

/// Where a frame is and how it moves in the world, world axes.
struct FrameMotion {
  Matrix3 R = Matrix3::Identity();             ///< its axes as columns
  Vector3 position = Vector3::Zero();          ///< [m]
  Vector3 angular_velocity = Vector3::Zero();  ///< [rad/s]
  Vector3 velocity = Vector3::Zero();          ///< of its origin [m/s]
};

/// A moment about the origin of a frame and a force there, world axes.
struct Wrench {
  Vector3 moment = Vector3::Zero();  ///< [N m]
  Vector3 force = Vector3::Zero();   ///< [N]
};

/// Where a switching function passed through zero.
struct Crossing {
  int function = -1;  ///< its index; −1: none did, an instant of the clock or a beginning
  int direction = 0;  ///< +1: from below, −1: from above
  /// The start of a run, or an event that switches the load on: it begins anew, whether an instant of its clock falls
  /// there or not.
  bool begins = false;
};

/// The part of a load that changes at instants alone: a digital controller, a relay. Its numbers are the load's
/// discrete states; they stand in State and are constant between two instants.
class DiscretePart {
 public:
  virtual ~DiscretePart() = default;
  /// Count of discrete states.
  [[nodiscard]] virtual std::size_t states() const = 0;
  /// [s]: `renew` is called at all multiples of it; 0: not by the clock. Finite, not negative, always the same.
  [[nodiscard]] virtual double period() const { return 0; }
  /// Count of switching functions: `renew` is called where one of them passes through zero.
  [[nodiscard]] virtual std::size_t switches() const { return 0; }
  /// Sets the values of the switching functions, finite, continuous between two instants.
  virtual void switching(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                         std::span<const double> /*discrete*/, std::span<double> /*values*/) const noexcept {}
  /// Sets the discrete states anew from those before and the state at t: at the start of a run and at each instant.
  /// \param scratch as BoundLoad::add
  virtual void renew(double t, std::span<const double> positions, std::span<const double> speeds,
                     const Crossing& crossing, std::span<double> discrete,
                     std::span<double> scratch) const noexcept = 0;
  /// Adds the efforts [N m, N] that belong to the discrete states at time t [s].
  virtual void add(double t, std::span<const double> discrete, std::span<double> efforts) const noexcept = 0;
  /// Adds what belongs to them to the wrenches that BoundLoad::wrenches has set.
  virtual void add_wrenches(double /*t*/, std::span<const double> /*discrete*/,
                            std::span<const FrameMotion> /*motions*/, std::span<Wrench> /*wrenches*/) const noexcept {}
};

/// What the continuous part of a load sees at a time: the whole state, its own part of it, and scratch space as
/// BoundLoad::add.
struct LoadView {
  double t;  ///< [s]
  const Layout& layout;
  std::span<const double> y;                     ///< as State::y
  std::span<const double> discrete, continuous;  ///< the load's own
  std::span<double> scratch;
  /// Of all speeds, where rates are asked for; empty where efforts are, on which they depend.
  std::span<const double> accelerations = {};

  [[nodiscard]] std::span<const double> positions() const { return y.first(layout.positions); }
  [[nodiscard]] std::span<const double> speeds() const { return y.subspan(layout.positions, layout.speeds); }
};

/// Derivatives of the efforts τ and of the rates ż that a ContinuousPart gives; z are its own states.
struct ContinuousDerivatives {
  Eigen::Ref<Eigen::MatrixXd> effort_by_position, effort_by_speed;  ///< as of BoundLoad::add_derivatives
  Eigen::Ref<Eigen::MatrixXd> effort_by_state;                      ///< speeds × z
  Eigen::Ref<Eigen::MatrixXd> rate_by_position, rate_by_speed;      ///< z × speeds
  Eigen::Ref<Eigen::MatrixXd> rate_by_state;                        ///< z × z
};

/// The part of a load with differential equations of its own, ż = g(t, x, u, z): the integral of a controller, a
/// filter, the current of a motor. Its numbers z are the load's continuous states; they stand in State and are
/// integrated with the motion, to the same tolerance.
class ContinuousPart {
 public:
  virtual ~ContinuousPart() = default;
  /// Count of continuous states; 0: efforts follow the whole state at once, without memory.
  [[nodiscard]] virtual std::size_t states() const = 0;
  /// Name of one of them: "integral". With the load's name it is that of the element of State. Of each its own, UTF-8,
  /// not empty, without comma, quotation mark, slash and control character.
  [[nodiscard]] virtual std::string name(std::size_t state) const = 0;
  /// Sets them for the start of a motion at the state in `view`, whose `continuous` means nothing.
  virtual void begin(const LoadView& view, std::span<double> continuous) const noexcept = 0;
  /// Sets ż, with the accelerations in `view`; smooth but at BoundLoad::discontinuities and at instants.
  virtual void rates(const LoadView& view, std::span<double> rates) const noexcept = 0;
  /// Adds the efforts [N m, N] that depend on them, beside those of BoundLoad::add.
  virtual void add(const LoadView& view, std::span<double> efforts) const noexcept = 0;
  /// Adds what depends on them to the wrenches that BoundLoad::wrenches has set at the load's frames.
  virtual void add_wrenches(const LoadView& /*view*/, std::span<const FrameMotion> /*motions*/,
                            std::span<Wrench> /*wrenches*/) const noexcept {}
  /// Adds the derivatives of `add` and of `rates`; may allocate. \returns false, adding nothing, where it has none: it
  /// is then differentiated numerically, as its wrenches always are, and as the whole part is where rates change with
  /// accelerations, for which there is no place here.
  virtual bool add_derivatives(const LoadView& /*view*/, ContinuousDerivatives& /*to*/) const { return false; }
};

/// Numbers that a load gives to loads which name it: the command of a controller.
class LoadOutput {
 public:
  virtual ~LoadOutput() = default;
  /// Count of them.
  [[nodiscard]] virtual std::size_t outputs() const = 0;
  /// Whether they depend on accelerations at once, so that they have no meaning where LoadView has none.
  [[nodiscard]] virtual bool needs_accelerations() const { return false; }
  /// Sets them from a view of the load whose output they are.
  virtual void read(const LoadView& view, std::span<double> values) const noexcept = 0;
};

/// Where and along what an input acts: on a generalized speed, or by a force or moment at a frame.
struct InputPlace {
  int speed = -1;  ///< index; −1: at the frame
  FrameIndex frame;
  Vector3 direction = Vector3::Zero();  ///< unit vector, in world axes or those of the frame
  bool following = false;               ///< in those of the frame
  bool moment = false;
};

/// A value that a host sets between the steps of a simulation. It is kept in the discrete states of its load, so that
/// a State knows it.
class InputPort {
 public:
  virtual ~InputPort() = default;
  /// SI unit of the value: "N m" or "N".
  [[nodiscard]] virtual std::string unit() const = 0;
  /// Where it acts, and what controllers add to it.
  [[nodiscard]] virtual InputPlace place() const = 0;
  /// Whether a value that is set is reached in a straight line at the end of the next step; else it holds at once.
  [[nodiscard]] virtual bool interpolates() const = 0;
  /// The value at time t [s].
  [[nodiscard]] virtual double value(double t, std::span<const double> discrete) const noexcept = 0;
  /// Whether a host has set it; until then the scene says what it is.
  [[nodiscard]] virtual bool is_set(std::span<const double> discrete) const noexcept = 0;
  /// From time t [s] on the value holds; where the port interpolates, it is reached at the time `reached` [s], in a
  /// straight line from the value at t.
  virtual void set(double t, double reached, double value, std::span<double> discrete) const noexcept = 0;
};

/// A load fixed to one model: it knows which generalized speeds and frames it acts on. Immutable; scratch space is the
/// caller's.
class BoundLoad {
 public:
  virtual ~BoundLoad() = default;
  /// Doubles of scratch space that `add` needs; their content does not matter before or after a call.
  [[nodiscard]] virtual std::size_t scratch() const = 0;
  /// Adds the load's generalized efforts [N m, N] at time t [s] to `efforts`, one for each generalized speed.
  /// `positions` and `speeds` are those of State.
  virtual void add(double t, std::span<const double> positions, std::span<const double> speeds,
                   std::span<double> efforts, std::span<double> scratch) const noexcept = 0;
  /// Adds the derivatives of the efforts that `add` gives: `by_position(i, j)` of effort i with respect to a
  /// displacement along speed j (position changes as if that speed alone were one), `by_speed(i, j)` to speed j. For
  /// analyses: may allocate. \returns false, adding nothing, where the load has none; it is then differentiated
  /// numerically.
  virtual bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                               Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                               Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const {
    return false;
  }
  /// Frames at which the load acts by wrenches. Which partial velocities turn these into efforts, and at which
  /// deformation the frames are shown to `wrenches`, is the formulation's (docs/theory.md, "Loads at frames").
  [[nodiscard]] virtual std::span<const FrameIndex> frames() const { return {}; }
  /// Sets the wrench at each of `frames()` from their motion at time t [s], all three in one order.
  virtual void wrenches(double /*t*/, std::span<const FrameMotion> /*motions*/,
                        std::span<Wrench> /*wrenches*/) const noexcept {}
  /// Times [s], increasing, where the effort or one of its first derivatives jumps: integrators land on them.
  [[nodiscard]] virtual std::vector<double> discontinuities() const = 0;
  /// What of the load changes at instants alone, beside what `add` and `wrenches` give; null where nothing does.
  [[nodiscard]] virtual const DiscretePart* discrete() const { return nullptr; }
  /// What of the load has differential equations of its own; null where nothing has.
  [[nodiscard]] virtual const ContinuousPart* continuous() const { return nullptr; }
  /// What it gives to other loads; null where nothing.
  [[nodiscard]] virtual const LoadOutput* output() const { return nullptr; }
  /// The value in the discrete states that a host sets; null where they are the load's own.
  [[nodiscard]] virtual const InputPort* input() const { return nullptr; }
  /// Time [s] at which the load has done its work (a slew's end); 0 where it has no end of its own.
  [[nodiscard]] virtual double end() const = 0;
  /// Sets the hinge coordinates where the load wants the motion to begin (a slew starts at its `from`) at the
  /// state's time, that of the scene; neither the time nor how many numbers there are.
  virtual void begin(State& state) const = 0;
  /// The load for the same tree compiled in these terms, its bodies in their strain kinematics, where it asks the model
  /// for more than indices; null where it is that one itself.
  [[nodiscard]] virtual std::unique_ptr<BoundLoad> rebound(const Model& /*model*/, const Terms& /*terms*/) const {
    return nullptr;
  }
};

/// A load as the scene states it.
class Load {
 public:
  virtual ~Load() = default;
  /// \throws std::invalid_argument where the load does not fit the model; the text says why.
  [[nodiscard]] virtual std::unique_ptr<BoundLoad> bind(const Model& model) const = 0;
};

}  // namespace withy
