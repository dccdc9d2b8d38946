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
/// The same, and of flexible bodies that are measured elsewhere too (measured_places) these stations: where studies
/// look at how bodies bend.
std::vector<Tip> measured_ends(const Model& model);

/// How far a body bends and turns at one place.
struct Bend {
  double deflection = 0;  ///< over the body's length
  double angle = 0;       ///< of the section there against the body's frame [rad]
  /// Whether the body is bent: a section that turns on a straight body, as the end of a shaft does, moves right at any
  /// angle, for what is dropped is of bending as it turns. Up to a thousandth of its length a body counts as straight:
  /// what deflections that hardly move are measured by (Outputs).
  [[nodiscard]] bool bent() const { return deflection > 1e-3; }
  /// What kinematics of second order is judged by: the deflection, or where the body is bent half of the angle, if that
  /// is more. An evenly bent body of which the end has turned by an angle is deflected by half as much over its length.
  [[nodiscard]] double size() const { return bent() && by_angle() ? angle / 2 : deflection; }
  /// Whether the angle says more than the deflection.
  [[nodiscard]] bool by_angle() const { return angle / 2 > deflection; }
};

/// Angle [rad] of the section at a tip against the frame of its body, to the first order in the coordinates; of a body
/// in segments 0.
double section_angle(const Model& model, std::span<const double> y, const Tip& tip);

/// Displacement of a tip in the frame of its body's root [m]. Of a body in segments this is the exact difference of
/// places in the world.
/// \param seen at the state
std::array<double, 3> deflection(const Observation& seen, const Tip& tip);
/// The same of one state alone.
std::array<double, 3> deflection(const EquationsOfMotion& equations, std::span<const double> y, const Tip& tip);

}  // namespace withy
