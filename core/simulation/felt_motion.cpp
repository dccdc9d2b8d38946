#include "withy/core/simulation/felt_motion.hpp"

#include <array>

#include "withy/core/deformation/mass_points.hpp"

namespace withy {
namespace {

Vector3 vector_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// By the place of mass that moves with a body frame: of the field itself, and of its velocity.
Matrix3 gradient_of(const Model& model, const State& state, const FrameMotion& at) {
  static const MassPoint unit{.mass = 1, .second = Matrix3::Zero(), .at = {}};
  Matrix3 gradient = Matrix3::Zero();
  for (const LoadNode& node : model.loads()) {
    const FieldLoad* field = acting_field(node, state.y);
    if (field == nullptr) continue;
    const FieldLoad::Slope slope = field->slope(state.time, unit, at);
    gradient += slope.block<3, 3>(3, 3) + slope.block<3, 3>(3, 9) * skew<double>(at.angular_velocity);
  }
  return gradient;
}

/// What fields exert on all mass of a body [N], its points to first order in the elastic coordinates.
Vector3 force_on(const Model& model, const ActingFields& fields, std::size_t body, const State& state,
                 const FrameMotion& frame) {
  const FieldLoad& points = *field_of(model);
  const Layout& layout = model.layout();
  const Slot* slot = layout.modes(body);
  Vector3 force = Vector3::Zero();
  for (const MassPoint& point : points.points_of(static_cast<int>(body))) {
    Vector3 r = point.at.X, r_rate = Vector3::Zero();
    for (std::size_t i = 0; slot != nullptr && i < slot->positions; ++i) {
      const Vector3 phi = point.at.phi.col(static_cast<Eigen::Index>(i));
      r += phi * state.y[slot->position + i];
      r_rate += phi * state.y[layout.positions + slot->speed + i];
    }
    FrameMotion m = frame;
    const Vector3 arm = frame.R * r;
    m.position += arm;
    m.velocity += frame.angular_velocity.cross(arm) + frame.R * r_rate;
    force += point.mass * fields.acceleration(state.time, state.y, m);
  }
  return force;
}

}  // namespace

std::vector<BodyMotion> felt_motions(const Model& model, const EquationsOfMotion& equations, const State& state,
                                     const std::vector<BodyMotion>& motions) {
  std::vector<BodyMotion> felt = motions;
  if (field_of(model) == nullptr) return felt;
  const ActingFields fields(model);
  const auto seen = equations.make_observation();
  seen->observe(state.y);
  std::vector<Vector3> forces(felt.size(), Vector3::Zero());  // that fields exert on all that hangs on a hinge
  for (std::size_t b = felt.size(); b-- > 0;) {
    BodyMotion& B = felt[b];
    const FrameMotion frame{B.R, B.p, B.rate, vector_of(seen->frame_velocity(static_cast<int>(b), 0).linear)};
    B.acceleration -= fields.acceleration(state.time, state.y, frame);
    B.gradient = gradient_of(model, state, frame);
    forces[b] += force_on(model, fields, b, state, frame);
    B.force -= forces[b];
    if (const int parent = model.hinges()[b].parent; parent >= 0) forces[static_cast<std::size_t>(parent)] += forces[b];
  }
  return felt;
}

}  // namespace withy
