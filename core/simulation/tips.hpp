/// \file
/// The free ends of bodies: what results tell of first.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// The frame "tip" of a body, or of one in segments; or another place that a flexible body is measured at.
struct Tip {
  std::string body;  ///< name, the whole's where it is in segments
  std::string station = "tip";
  FrameIndex root;    ///< frame "root" of the body or of its first segment
  FrameIndex tip;     ///< frame "tip" of the body or of its last segment
  Vector3 at;         ///< place of the tip in the root's frame, undeformed [m]; of segments alone
  double length = 0;  ///< characteristic length [m] of the whole
  bool flexible = false;
  [[nodiscard]] bool in_segments() const { return root.body != tip.body; }
};

/// The tip of every body that has one, in the order of the model's bodies.
std::vector<Tip> tips(const Model& model);
/// The same, and of flexible bodies that are measured elsewhere (measured_place) that station: where studies look at
/// how bodies bend.
std::vector<Tip> measured_ends(const Model& model);

/// Displacement of a tip in the frame of its body's root [m]. Of a body in segments this is the exact difference of
/// places in the world.
/// \param seen at the state
std::array<double, 3> deflection(const Observation& seen, const Tip& tip);
/// The same of one state alone.
std::array<double, 3> deflection(const EquationsOfMotion& equations, std::span<const double> y, const Tip& tip);

}  // namespace withy
