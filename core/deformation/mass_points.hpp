/// \file
/// The mass of bodies as points where loads on distributed mass act.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/effortless_load.hpp"

namespace withy {

/// Mass of a body at one place of it, with what turns there: a particle, a section with rotary inertia, or both.
struct MassPoint {
  double mass = 0;                   ///< [kg]
  Matrix3 second = Matrix3::Zero();  ///< Σ m ρ ρᵀ about the place, axes of its section [kg m²]
  PointExpansion at;
};

/// All mass of a body. Of a rod they are the nodes of its own quadrature, fewer than the particles of its shape and as
/// good, and on its axis, where exact kinematics has them; of any other body the particles and sections of its shape.
std::vector<MassPoint> mass_points(const Body& body);

/// Of a rod: the share of each of its mass points that lies beyond x [m]. Empty where the body is no rod.
std::vector<double> mass_beyond(const Body& body, double x);

/// The mass of a part of a body that is no rod: as mass_points has that of the whole, of a body without modes as one
/// point, its centre.
std::vector<MassPoint> mass_points(const std::vector<Particle>& particles, const std::vector<Section>& sections,
                                   Eigen::Index modes);

/// A load on distributed mass: its wrench at a mass point depends on the motion of that point alone; at one without
/// second moments it is a force, and the point's turning, which nobody finds, is that of its body. The mass points of
/// all bodies are frames to it, and to whatever asks where it acts: those of body b are {b, −1}, {b, −2}, …
class FieldLoad : public EffortlessLoad {
 public:
  explicit FieldLoad(const Model& model);
  /// Of the wrench at a mass point (moment, force) by a turn, the position, the angular velocity and the velocity of
  /// the point, three columns each, world axes.
  using Slope = Eigen::Matrix<double, 6, 12>;

  [[nodiscard]] virtual Wrench wrench(double t, const MassPoint& point, const FrameMotion& motion) const noexcept = 0;
  [[nodiscard]] virtual Slope slope(double t, const MassPoint& point, const FrameMotion& motion) const = 0;

  [[nodiscard]] const MassPoint& point(FrameIndex at) const;
  /// Of a body of the model.
  [[nodiscard]] std::span<const MassPoint> points_of(int body) const;
  /// What the load gives mass that moves so, at time t [s]: an acceleration [m/s²], world axes.
  [[nodiscard]] Vector3 acceleration(double t, const FrameMotion& motion) const noexcept {
    return wrench(t, unit_, motion).force;
  }
  /// Whether the bodies of the model are those that the load is bound to.
  [[nodiscard]] bool is_of(const Model& model) const;

  std::span<const FrameIndex> frames() const override { return frames_; }
  void wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept override;

 private:
  std::vector<std::shared_ptr<const Body>> bodies_;
  std::vector<std::size_t> first_;  ///< mass point of each body; their count at the end
  std::vector<MassPoint> points_;
  MassPoint unit_{.mass = 1, .second = Matrix3::Zero(), .at = {}};  ///< [kg]
  std::vector<FrameIndex> frames_;
};

/// The first load on distributed mass that a model has; null where it has none.
const FieldLoad* field_of(const Model& model);
/// Whether a load acts on distributed mass at some state.
bool acts_on_mass(const LoadNode& node);
/// The load on distributed mass that a load is at y, as State::y; null where it is none then.
const FieldLoad* acting_field(const LoadNode& node, std::span<const double> y) noexcept;

/// All of these loads of a model, found once: what a load is takes longer to ask than what it gives.
class ActingFields {
 public:
  ActingFields() = default;  ///< none
  /// \param model must outlive this
  explicit ActingFields(const Model& model);
  /// What they give mass that moves so, at (t, y) as of State: an acceleration [m/s²], world axes.
  [[nodiscard]] Vector3 acceleration(double t, std::span<const double> y, const FrameMotion& motion) const noexcept;
  /// What they exert there on a mass point that moves so.
  [[nodiscard]] Wrench wrench(double t, std::span<const double> y, const MassPoint& point,
                              const FrameMotion& motion) const noexcept;

 private:
  std::vector<const LoadNode*> loads_;
};

/// Where a frame or, under a load on distributed mass, a mass point is fixed: at `pose` in a section of its body.
struct FramePlace {
  const PointExpansion& section;
  Pose pose;
};
FramePlace place_of(const Model& model, FrameIndex at);

/// Whether a model has a frame or, under a load on distributed mass, a mass point of this index.
bool has_place(const Model& model, FrameIndex at);
/// "frame 7 of body 'arm'": of an index that a model may not have.
std::string frame_in_words(const Model& model, FrameIndex at);

}  // namespace withy
