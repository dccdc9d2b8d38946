/// \file
/// Efforts of a model's loads in one formulation.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/kinematics/frame_paths.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/timed_effort.hpp"

namespace withy {

/// A load of a model that is a function of time alone.
struct TimedLoad {
  const TimedEffort* effort = nullptr;  ///< null: it is none
  std::size_t speed = 0;
  std::shared_ptr<const void> law = nullptr;  ///< as TimedEffort::law
};

/// All loads of a model: those on generalized speeds, and those at frames through the formulation's partial velocities.
class AppliedLoads {
 public:
  /// `terms` hold for every body that has none of its own. The model must outlive the loads.
  AppliedLoads(const Model& model, Terms terms);
  /// Bytes of memory that `add` needs, aligned to 64.
  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  /// Adds the efforts at time t [s], y as in State, of all loads or of one (index in Model::loads()).
  void add(double t, std::span<const double> y, std::span<double> efforts, std::byte* work,
           int only = -1) const noexcept;
  /// The same of all loads for who has the efforts of timed() at t, in their order.
  void add_to_timed(double t, std::span<const double> y, std::span<const double> timed, std::span<double> efforts,
                    std::byte* work) const noexcept;
  /// One a load of the model.
  [[nodiscard]] const std::vector<TimedLoad>& timed() const { return timed_; }
  /// Whether these are all that loads do.
  [[nodiscard]] bool only_timed() const;
  /// Sets the derivatives of the loads' continuous states in y_dot; false where one of them is not finite.
  bool rates(double t, std::span<const double> y, std::span<double> y_dot, std::byte* work) const noexcept;
  /// Frames at which loads act, load after load.
  [[nodiscard]] const std::vector<FrameIndex>& frames() const { return frames_; }
  /// The wrenches there at (t, y), world axes, in the work memory.
  std::span<const Wrench> wrenches(double t, std::span<const double> y, std::byte* work, int only = -1) const noexcept;

 private:
  [[nodiscard]] std::span<double> scratch(std::byte* work) const noexcept;
  /// What loads add beside BoundLoad::add.
  void add_rest(double t, std::span<const double> y, std::span<double> efforts, std::byte* work,
                int only) const noexcept;

  const Model& model_;
  std::unique_ptr<const FramePaths> paths_;  ///< of the loads' frames, load after load; null: none acts at a frame
  std::vector<FrameIndex> frames_;
  std::vector<TimedLoad> timed_;
  std::size_t scratch_offset_ = 0, motions_offset_ = 0, wrenches_offset_ = 0, paths_offset_ = 0, work_size_ = 0;
};

}  // namespace withy
