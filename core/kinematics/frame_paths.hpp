/// \file
/// Motion of frames of a model, and the efforts of wrenches at them, along the bodies between them and the world.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// Chosen frames of a model in one formulation, by recursion over the bodies that carry them: outward for their motion,
/// inward for the efforts Σ J_ωᵀ m + J_vᵀ f of wrenches at them. Either costs as many steps as there are such bodies.
///
/// Motion is that of the bodies' strain kinematics at q, q̇; of a ruthless body at q = 0, q̇ = 0. The partial velocities
/// are those of the same motion, but under strict truncation linear in q: J(0) + dJ(εq)/dε; under symmetric truncation
/// so for modes, and to second order for hinges, that the efforts of a dead force have a potential.
class FramePaths {
 public:
  /// `terms` hold for every body that has none of its own. The model must outlive the paths.
  /// \param untruncated as if no body were truncated, as sensors see frames
  FramePaths(const Model& model, Terms terms, const std::vector<FrameIndex>& frames, bool untruncated = false);
  ~FramePaths();
  /// Bytes of memory that the functions below share, aligned to 64.
  [[nodiscard]] std::size_t work_size() const { return work_size_; }

  /// Motion of the frames, in their order, at positions and speeds as in State.
  void motions(std::span<const double> positions, std::span<const double> speeds, std::span<FrameMotion> motions,
               std::byte* work) const noexcept;
  /// Accelerations J̇ u that the frames have where no speed changes, at the state that `motions` has left in the memory;
  /// of untruncated paths.
  void velocity_accelerations(std::span<FrameAcceleration> accelerations, std::byte* work) const noexcept;
  /// Adds the efforts of a wrench at each frame to `efforts`, at the state that `motions` has left in the memory.
  void add_efforts(std::span<const Wrench> wrenches, std::span<double> efforts, std::byte* work) const noexcept;

 private:
  struct Rod;
  /// A section of a body where frames are fixed.
  struct Section {
    PointExpansion at;
    bool moves;            ///< false: the modes leave it where it is
    bool turns;            ///< false: a particle alone is there, whose turning nobody asks for
    std::size_t partials;  ///< its first place among them, where it moves
    std::size_t station;   ///< of a rod
    /// Γ and Θ by pairs of modes, one row of the matrices after the other; empty where zero.
    std::vector<Vector3> gamma, theta;
  };
  /// A frame at `pose` in a section of a link.
  struct Place {
    std::size_t link;
    std::size_t section;
    Pose pose;
  };
  /// A body on the way.
  struct Link {
    const HingeNode* hinge;
    Slot slot;      ///< of the hinge
    bool at_world;  ///< F is fixed to the world, at `F.pose`
    Place F;        ///< else it is there
    Place M;        ///< on this link
    Eigen::Index modes;
    Slot modal;        ///< of the modes
    std::size_t mode;  ///< first place of them among those of all links
    StrainOrder order;
    Truncation truncation;
    std::vector<std::size_t> sections;
    bool particles = false;          ///< some section does not turn
    std::shared_ptr<const Rod> rod;  ///< null where the kinematics is an expansion
  };
  /// The motion of all links in a scalar, in the work memory.
  template <class S>
  class Pass;

  std::size_t link(const Model& model, Terms terms, int body);
  Place place(const Model& model, Terms terms, FrameIndex frame, const Pose& offset);

  std::vector<Link> links_;   ///< parents first
  std::vector<int> link_of_;  ///< of each body; −1: none
  std::vector<Section> sections_;
  std::vector<Place> frames_;
  std::size_t modes_ = 0;
  std::size_t partials_ = 0;
  bool untruncated_ = false, strict_ = false, symmetric_ = false;
  std::size_t hinge_offset_ = 0, partials_offset_ = 0, full_offset_ = 0, first_order_offset_ = 0;
  std::size_t turning_offset_ = 0, gathered_offset_ = 0, by_mode_offset_ = 0, work_size_ = 0;
};

}  // namespace withy
