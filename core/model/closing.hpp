/// \file
/// Constraints that close loops: a hinge between two frames of the tree, as equations that it leaves no freedom.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/hinge.hpp"

namespace withy {

/// One scalar equation between the hinge frames F and M of a closing hinge, g = 0 with
///   of positions:   g = a · p_FM − value,
///   of directions:  g = a · (R_FM b) − value.
struct ClosingEquation {
  bool of_directions = false;
  Vector3 a = Vector3::Zero();  ///< unit vector in F
  Vector3 b = Vector3::Zero();  ///< unit vector in M; of directions alone
  double value = 0;             ///< [m], or 1
};

/// The 6 − speeds equations that hold at every pose of a hinge and at no other near by; nothing where the hinge is not
/// made of rotations about fixed axes and translations along fixed directions (screws), or leaves everything free.
std::optional<std::vector<ClosingEquation>> closing_equations(const Hinge& hinge);

/// A hinge that closes a loop: F is at `offset` in frame a, M is frame b. It is bound to a model where loads are, since
/// what it exerts are wrenches at frames; their sizes are the multipliers of the equations of motion, so that of itself
/// it gives none. A body −1 is the world.
class LoopClosure final : public EffortlessLoad {
 public:
  /// \throws std::invalid_argument where both frames are on one body, or both in the world.
  LoopClosure(const Model& model, std::string name, FrameIndex a, FrameIndex b, Pose offset,
              std::vector<ClosingEquation> equations);
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const FrameIndex& a() const { return a_; }
  [[nodiscard]] const FrameIndex& b() const { return b_; }
  [[nodiscard]] const Pose& offset() const { return offset_; }
  [[nodiscard]] const std::vector<ClosingEquation>& equations() const { return equations_; }

 private:
  std::string name_;
  FrameIndex a_, b_;
  Pose offset_;
  std::vector<ClosingEquation> equations_;
};

/// The loops of a model, in their order.
std::vector<const LoopClosure*> loops_of(const Model& model);
/// Whether a loop runs through the inboard hinge of a body: it is on the way, within the tree, from one frame of a loop
/// to the other.
bool in_loop(const Model& model, std::size_t body);
/// in_loop of all hinges. What carries a loop with both its ends is none of its own.
std::vector<bool> hinges_in_loops(const Model& model);
/// The generalized speeds that change the shape of a loop: of its hinges and its bodies, that from which its two sides
/// go out included. What carries a loop moves it as a whole.
std::vector<bool> speeds_in_loops(const Model& model);
/// ℓ [m] of a model's loops, by which rotations count as gaps: the length of the longest flexible body, or where that
/// is more the greatest distance from its body's root of a frame that a hinge or a constraint joins, or of a hinge or
/// closing frame from what it is placed in; 1 where all are at one place.
double length_of_loops(const Model& model);
/// How fast unit speeds move what is `length` [m] away from what they turn, about: one a generalized speed, > 0. Of a
/// hinge's rate at its reference; of a mode at the place of its body where that is most.
std::vector<double> reaches_of_speeds(const Model& model, double length);
/// \throws std::invalid_argument where the model has loops; `what` knows nothing of them.
void require_tree(const Model& model, const std::string& what);

}  // namespace withy
