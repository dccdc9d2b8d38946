/// \file
/// Poses of frames that an observation has.
#pragma once

#include "withy/core/plugin/equations.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// X_WF of a frame at the state that was observed last.
inline Pose seen_pose(const Observation& seen, int body, int frame) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const WorldPose at = seen.frame_pose(body, frame);
  return {Eigen::Map<const RowMajor>(at.rotation.data()), Eigen::Map<const Vector3>(at.position.data())};
}

}  // namespace withy
