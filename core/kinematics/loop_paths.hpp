/// \file
/// The equations of a model's closed loops at a state: gaps, their rates, and the efforts of multipliers.
#pragma once

#include <span>
#include <vector>

#include "withy/core/kinematics/frame_paths.hpp"
#include "withy/core/model/closing.hpp"

namespace withy {

/// With g the gaps of all closing equations, those of directions times `length`, and J u = ġ. Geometry is not truncated
/// in any formulation: it is that of the bodies' strain kinematics, so that J is the derivative of g and Jᵀ its exact
/// transpose. With F = (R, p) on a, M on b, r = p_M − p_F and the directions d = R_F a, f = R_M b in world axes,
///   of positions   ġ = d · (v_M − v_F) − (ω_F × r) · d          and the force d at p_M on b, −d there on a;
///   of directions  ġ = ℓ (ω_M − ω_F) · (f × d)                  and the moment ℓ f × d on b, its opposite on a.
class LoopPaths {
 public:
  /// What stands for the gaps of hinges that hold two directions or all three.
  enum class Held {
    equations,  ///< g as above, which some turns by half and by a third of a circle solve too
    /// Of three, ℓ (b × a) · θ, θ the rotation vector of R_FM in F, and ω_FM for its rate; of two, which hold an axis,
    /// ℓ a · θ' with θ' the turn that is left for that axis, along its way. Equal to g near the hinge's pose.
    turn
  };
  /// `terms` as in FramePaths. The model must outlive the paths.
  LoopPaths(const Model& model, Terms terms);
  /// Of equations, in all loops.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// ℓ [m], see length_of_loops.
  [[nodiscard]] double length() const { return length_; }
  /// What rounding leaves of a row of J that is zero, over reaches_of_speeds, at the state that `gaps` has left in the
  /// memory: arms are differences of places, which have fewer digits the farther they are from the world's origin.
  [[nodiscard]] double rounding(std::byte* work) const noexcept;
  /// Bytes of memory that the functions below share, aligned to 64.
  [[nodiscard]] std::size_t work_size() const { return work_size_; }

  /// Goes to a state, y as in State, and sets g.
  void gaps(std::span<const double> y, std::span<double> gaps, std::byte* work,
            Held held = Held::equations) const noexcept;
  /// At the state that `gaps` has left in the memory: J u, and J̇ u.
  void rates(std::span<double> rates, std::byte* work) const noexcept;
  void biases(std::span<double> biases, std::byte* work) const noexcept;
  /// Frames of bodies that loops act on, loop after loop.
  [[nodiscard]] std::span<const FrameIndex> frames() const { return frames_; }
  /// The wrench of multipliers λ at each: about its origin, world axes.
  void wrenches(std::span<const double> multipliers, std::span<Wrench> wrenches, std::byte* work,
                Held held = Held::equations) const noexcept;
  /// Adds Jᵀ λ to the efforts.
  void add_efforts(std::span<const double> multipliers, std::span<double> efforts, std::byte* work,
                   Held held = Held::equations) const noexcept;
  /// What loop `index` exerts on the body of b: about the origin of M, world axes; and F's axes as columns.
  [[nodiscard]] Wrench on_b(std::size_t index, std::span<const double> multipliers, std::byte* work,
                            Held held = Held::equations) const noexcept;
  [[nodiscard]] Matrix3 axes(std::size_t index, std::byte* work) const noexcept;
  /// Whether a hinge is at the pose its equations stand for, not turned over to another one that solves them too.
  [[nodiscard]] bool right_way_round(std::size_t index, std::byte* work) const noexcept;

 private:
  /// One of the two ends of a loop: a frame of the paths, or fixed in the world.
  struct End {
    int frame = -1;
    Pose pose;  ///< of F or M in it
  };
  struct Loop {
    End a, b;
    const LoopClosure* node;
    std::size_t directions;  ///< equations of directions
  };
  struct Moving {
    FrameMotion F, M;
  };
  [[nodiscard]] Moving moving(const Loop& loop, std::byte* work) const noexcept;
  [[nodiscard]] FrameAcceleration accelerated(const End& end, const FrameMotion& at, std::byte* work) const noexcept;
  [[nodiscard]] static FrameMotion motion(const End& end, const FrameMotion* motions) noexcept;

  const Model& model_;
  std::vector<FrameIndex> frames_;
  FramePaths paths_;
  std::vector<Loop> loops_;
  std::size_t size_ = 0;
  double length_ = 0;
  std::size_t motions_offset_ = 0, accelerations_offset_ = 0, wrenches_offset_ = 0, paths_offset_ = 0, work_size_ = 0;
};

}  // namespace withy
