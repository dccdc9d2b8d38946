/// \file
/// The immutable tree of bodies, hinges and loads. Threads share it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/state.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

struct SensorNode;

/// A frame of a body: fixed at `pose` to the section at a station. Every body has the frame "root" with pose identity.
struct Frame {
  std::string name;
  PointExpansion section;
  Pose pose;
};

/// Says that a body is a segment of one that was cut across. The segments of a whole lie one behind the other, welded,
/// from its root on; each has the frames "root" and "tip".
struct Segment {
  std::string whole;                      ///< name of the body that was cut; no body of the model has it
  std::size_t index = 0;                  ///< from the root, from 0
  std::size_t count = 1;                  ///< of the whole
  std::shared_ptr<const Body> body = {};  ///< the whole as one piece; null: not known
};

/// A body in the tree.
struct BodyNode {
  std::string name;
  std::shared_ptr<const Body> body;
  std::vector<Frame> frames;
  std::optional<Terms> terms = {};      ///< of this body's own formulation; none: the scene's
  std::optional<Segment> segment = {};  ///< none: a body by itself

  /// Index of a frame; −1 where there is none.
  [[nodiscard]] int frame(std::string_view frame_name) const;
  /// The body's name in the scene: of a segment that of the whole.
  [[nodiscard]] const std::string& scene_name() const { return segment ? segment->whole : name; }
};

/// A hinge in the tree, with its child. The hinge frame F is at `offset` in the parent's frame; M is the child's frame.
struct HingeNode {
  std::string name;
  std::shared_ptr<const Hinge> hinge;
  int parent = -1;       ///< index among the bodies; −1: world
  int parent_frame = 0;  ///< index among the parent's frames; meaningless for the world
  Pose offset;
  int child = 0;
  int child_frame = 0;
  /// n² J of a rotor of inertia J that turns n times as fast as a hinge of one rate, by a gear on its axis [kg m²; of a
  /// slide kg]: an inertia on that rate alone, T = ½ n² J ẋ², since what else turns the rotor is slow beside it.
  double reflected_inertia = 0;
};

/// A load in the tree.
struct LoadNode {
  std::string name;
  std::shared_ptr<const BoundLoad> load;
  LoadSlot slot = {};                          ///< of its discrete states; count 0: it has none
  LoadSlot continuous_slot = {};               ///< of its continuous states; likewise
  const ContinuousPart* continuous = nullptr;  ///< its continuous part

  /// Its discrete states in y, laid out as State::y.
  template <class T>
  [[nodiscard]] std::span<T> discrete(std::span<T> y) const {
    return y.subspan(slot.first, slot.count);
  }
  /// What its continuous part sees of y in a model of this layout.
  [[nodiscard]] LoadView view(double t, std::span<const double> y, const Layout& layout,
                              std::span<double> scratch) const {
    return {t, layout, y, discrete(y), y.subspan(continuous_slot.first, continuous_slot.count), scratch};
  }
  /// Sets the wrench at each of the load's frames, with what its states in y add.
  /// \param scratch as BoundLoad::add
  void wrenches(double t, std::span<const double> y, const Layout& layout, std::span<const FrameMotion> motions,
                std::span<Wrench> wrenches, std::span<double> scratch) const noexcept;
};

/// A prescribed motion in the tree.
struct MotionNode {
  std::string name;
  int hinge = 0;  ///< index among the hinges
  std::shared_ptr<const Motion> motion;
};

/// A tree of bodies. Hinge i carries body i: hinges()[i].child == i, and every parent has a smaller index.
class Model {
 public:
  /// Builds a tree from bodies and hinges in any order.
  /// \throws std::invalid_argument where a body has no hinge or two, the hinges make a cycle, a body's shape or frame
  /// has a fault (validate.hpp), or a reflected inertia is none; the text names them.
  Model(std::vector<BodyNode> bodies, std::vector<HingeNode> hinges, Vector3 gravity);

  [[nodiscard]] const std::vector<BodyNode>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<HingeNode>& hinges() const { return hinges_; }
  [[nodiscard]] const std::vector<LoadNode>& loads() const { return loads_; }
  [[nodiscard]] const std::vector<MotionNode>& motions() const { return motions_; }
  /// Whether a motion prescribes all coordinates of a hinge.
  [[nodiscard]] bool driven(std::size_t hinge) const;
  /// Whether events may lock a hinge, or unlock it: then what holds it is told as the effort of a motion.
  [[nodiscard]] bool may_be_locked(std::size_t hinge) const { return may_be_locked_[hinge]; }
  /// Acceleration of gravity [m/s²], world axes.
  [[nodiscard]] const Vector3& gravity() const { return gravity_; }
  [[nodiscard]] const Layout& layout() const { return layout_; }
  /// Index of a body or hinge; −1 where there is none.
  [[nodiscard]] int body(std::string_view name) const;
  [[nodiscard]] int hinge(std::string_view name) const;
  /// The frame that "body.frame" names, or "body" for its root. The name of a body that was cut stands for its
  /// segments: its root is that of the first, its tip that of the last, and any other frame that of the segment which
  /// has it.
  [[nodiscard]] std::optional<FrameIndex> find_frame(std::string_view name) const;
  /// Indices of the pieces of a body that was cut, from its root; of any other body its index alone; empty where there
  /// is no such body.
  [[nodiscard]] std::vector<int> segments(std::string_view body) const;

  /// Doubles of scratch space with which every load can be evaluated.
  [[nodiscard]] std::size_t load_scratch() const { return load_scratch_; }
  /// The state at time 0 with every coordinate at its reference, at rest, continuous states as they begin there.
  [[nodiscard]] State reference_state() const;
  /// Puts driven hinges where their motions have them at the state's time; locked ones stay, at rest, and those that a
  /// host moves as they are.
  void prescribe(State& state) const;
  /// Sets the accelerations of the driven speeds at time t [s] in u_dot, one a speed; leaves the others.
  void prescribe_accelerations(double t, std::span<double> u_dot) const noexcept;
  /// Sets the continuous states of all loads as they begin at the state.
  void begin_continuous(State& state) const;
  /// Adds the efforts [N m, N] of the loads' own states in y at time t, of all loads or of one (index in loads()).
  /// \param scratch load_scratch() doubles
  void add_state_efforts(double t, std::span<const double> y, std::span<double> efforts, std::span<double> scratch,
                         int only = -1) const noexcept;
  /// Sets the derivatives of the continuous states in y_dot, laid out as y; leaves the others. False where one of them
  /// is not finite.
  bool continuous_rates(double t, std::span<const double> y, std::span<double> y_dot,
                        std::span<double> scratch) const noexcept;
  /// The same tree with every body rigid in its undeformed shape, without loads and motions.
  [[nodiscard]] Model rigidified() const;

  /// Whether the modes of a body are those of exact kinematics, which is that of equations without truncation; `scene`:
  /// of the bodies that have no terms of their own.
  [[nodiscard]] bool is_exact(std::size_t body, const Terms& scene) const;
  /// \throws std::invalid_argument where a body is to be exact that offers no rod, or one with a fault (validate.hpp).
  void require_rods(const Terms& scene) const;
  /// The same tree with the bodies in the strain kinematics that their terms name, `scene` where they have none.
  /// \throws std::invalid_argument where a body cannot be; the text names it and the kinematics. As require_rods.
  [[nodiscard]] static std::shared_ptr<const Model> in_kinematics(std::shared_ptr<const Model> model,
                                                                  const Terms& scene);

  /// Adds a load, bound to this model. For builders of a model, before it is shared and before it has states.
  /// \throws std::invalid_argument as Load::bind; where its clock has no finite period, or its counts are beyond 2³².
  void add_load(std::string name, const Load& load);
  /// Puts another load, with the same states, in the place of one that is bound already. For builders of a model,
  /// before it is compiled: loads that measure the one hear of it as they are bound to the compiled model.
  void replace_load(std::size_t index, std::shared_ptr<const BoundLoad> load);
  /// Sensors that loads may measure, by their names; those without a sensor exist and cannot be measured.
  [[nodiscard]] const std::vector<SensorNode>* measured() const { return measured_.get(); }
  /// For builders of a model, before loads are added.
  void set_measured(std::shared_ptr<const std::vector<SensorNode>> sensors) { measured_ = std::move(sensors); }
  /// For builders of a model, before sensors are bound to it.
  void expect_lock(std::size_t hinge) { may_be_locked_[hinge] = true; }
  /// Prescribes the motion of a hinge. For builders of a model, before it is shared.
  /// \throws std::invalid_argument where there is no such hinge, it cannot move so, or it is driven already.
  void add_motion(std::string name, const std::string& hinge, std::shared_ptr<const Motion> motion);

 private:
  void lay_out();

  std::vector<BodyNode> bodies_;
  std::vector<HingeNode> hinges_;
  std::vector<LoadNode> loads_;
  std::vector<MotionNode> motions_;
  Vector3 gravity_;
  Layout layout_;
  std::size_t load_scratch_ = 0;
  std::vector<int> bodies_by_name_, hinges_by_name_;  ///< indices in the order of names
  std::vector<bool> driven_, may_be_locked_;          ///< by hinge
  std::shared_ptr<const std::vector<SensorNode>> measured_;
};

}  // namespace withy
