/// \file
/// What bodies feel of the motion of a tree and of loads on it that do not act along its hinges.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// The motions without what fields give: a satellite in free fall carries no load from its orbit. Forces are those on
/// all mass points, where the bodies' first order has them; over a body a field counts as linear, by its value and its
/// gradient at the body's frame, which is exact but for point-gravity: there the rest is of the order (l/d)² of the
/// gradient's part, with l the length of the body and d the distance. And with what loads and closed loops exert at
/// frames.
class FeltMotion {
 public:
  /// The model and the equations must outlive the object.
  FeltMotion(const Model& model, const EquationsOfMotion& equations);
  /// At a state of the equations and the motions there. Allocates where the model has fields.
  void update(const State& state, const std::vector<BodyMotion>& motions);
  /// One a body of the model, as at the last update.
  [[nodiscard]] const std::vector<BodyMotion>& bodies() const { return bodies_; }
  /// ω of a body's frame [rad/s], world axes, with that of axes in which a field acts: what accelerates across a
  /// velocity v by −2 Ω × v is to bodies as if all turned by Ω.
  [[nodiscard]] Vector3 turning(std::size_t body) const {
    return turning_.empty() ? bodies_[body].rate : Vector3(bodies_[body].rate + turning_[body]);
  }
  /// What loads exert at their frames, world axes, in the order of the model's loads and of the frames of each, then
  /// what loops exert, in the order of ClosedLoops::frames; as at the last update.
  [[nodiscard]] std::span<const Wrench> at_frames() const { return wrenches_; }

 private:
  void take_fields(const State& state);
  void add_loads(const State& state);

  const Model& model_;
  const ClosedLoops* loops_;           ///< null: the equations are a tree's
  Work loops_work_;                    ///< of the equations
  std::vector<double> multipliers_;    ///< of the loops [N]
  std::unique_ptr<Observation> seen_;  ///< null: there is nothing to be seen for
  std::vector<BodyMotion> bodies_;
  std::vector<Vector3> turning_;    ///< of the axes of fields, one a body; empty: there are none
  std::vector<FrameIndex> frames_;  ///< at which loads act, load after load, then loops
  bool at_frames_ = false;          ///< some act at frames of bodies
  std::vector<FrameMotion> motions_;
  std::vector<Wrench> wrenches_;
  std::vector<double> scratch_;
};

}  // namespace withy
