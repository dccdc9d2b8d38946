#include "withy/core/simulation/felt_motion.hpp"

#include <algorithm>
#include <array>

#include "withy/core/deformation/mass_points.hpp"

namespace withy {
namespace {

Vector3 vector_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Calls `meet(slope)` for every field that acts, of mass that moves with a body frame.
template <class Meet>
void meet_slopes(const Model& model, const State& state, const FrameMotion& at, Meet&& meet) {
  static const MassPoint unit{.mass = 1, .second = Matrix3::Zero(), .at = {}};
  for (const LoadNode& node : model.loads())
    if (const FieldLoad* field = acting_field(node, state.y)) meet(field->slope(state.time, unit, at));
}

/// By the place of mass that moves with a body frame: of the field itself, and of its velocity.
Matrix3 gradient_of(const Model& model, const State& state, const FrameMotion& at) {
  Matrix3 gradient = Matrix3::Zero();
  meet_slopes(model, state, at, [&](const FieldLoad::Slope& slope) {
    gradient += slope.block<3, 3>(3, 3) + slope.block<3, 3>(3, 9) * skew<double>(at.angular_velocity);
  });
  return gradient;
}

/// Of the axes of fields, by what they give velocities across them: Coriolis' acceleration −2 Ω × v.
Vector3 turning_of(const Model& model, const State& state, const FrameMotion& at) {
  Vector3 turning = Vector3::Zero();
  meet_slopes(model, state, at, [&](const FieldLoad::Slope& slope) {
    const Matrix3 C = slope.block<3, 3>(3, 9);
    turning -= 0.25 * Vector3(C(2, 1) - C(1, 2), C(0, 2) - C(2, 0), C(1, 0) - C(0, 1));
  });
  return turning;
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

/// Whether a load acts there on a body; else on distributed mass, or on the world.
bool is_frame(FrameIndex at) { return at.body >= 0 && at.frame >= 0; }

}  // namespace

FeltMotion::FeltMotion(const Model& model, const EquationsOfMotion& equations)
    : model_(model),
      loops_(dynamic_cast<const ClosedLoops*>(&equations)),
      loops_work_(0),
      bodies_(model.bodies().size()),
      scratch_(model.load_scratch()) {
  for (const LoadNode& node : model.loads())
    frames_.insert(frames_.end(), node.load->frames().begin(), node.load->frames().end());
  if (loops_ != nullptr) {
    frames_.insert(frames_.end(), loops_->frames().begin(), loops_->frames().end());
    multipliers_.resize(loops_->closing_equations());
    loops_work_ = equations.make_work();
  }
  motions_.resize(frames_.size());
  wrenches_.resize(frames_.size());
  at_frames_ = std::any_of(frames_.begin(), frames_.end(), is_frame);
  if (at_frames_ || field_of(model) != nullptr) seen_ = equations.make_observation();
}

void FeltMotion::update(const State& state, const std::vector<BodyMotion>& motions) {
  bodies_ = motions;
  if (seen_ == nullptr) return;
  seen_->observe(state.y);
  if (field_of(model_) != nullptr) take_fields(state);
  if (at_frames_) add_loads(state);
}

void FeltMotion::take_fields(const State& state) {
  const ActingFields fields(model_);
  turning_.assign(bodies_.size(), Vector3::Zero());
  std::vector<Vector3> forces(bodies_.size(), Vector3::Zero());  // that fields exert on all that hangs on a hinge
  for (std::size_t b = bodies_.size(); b-- > 0;) {
    BodyMotion& B = bodies_[b];
    const FrameMotion frame{B.R, B.p, B.rate, vector_of(seen_->frame_velocity(static_cast<int>(b), 0).linear)};
    B.acceleration -= fields.acceleration(state.time, state.y, frame);
    B.gradient = gradient_of(model_, state, frame);
    turning_[b] = turning_of(model_, state, frame);
    forces[b] += force_on(model_, fields, b, state, frame);
    B.force -= forces[b];
    if (const int parent = model_.hinges()[b].parent; parent >= 0)
      forces[static_cast<std::size_t>(parent)] += forces[b];
  }
}

void FeltMotion::add_loads(const State& state) {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!is_frame(frames_[i])) continue;
    const WorldPose pose = seen_->frame_pose(frames_[i].body, frames_[i].frame);
    const WorldVelocity velocity = seen_->frame_velocity(frames_[i].body, frames_[i].frame);
    motions_[i] = {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()),
                   vector_of(pose.position), vector_of(velocity.angular), vector_of(velocity.linear)};
  }
  std::size_t first = 0;
  for (const LoadNode& node : model_.loads()) {
    const std::size_t count = node.load->frames().size();
    if (count > 0 && frames_[first].frame >= 0)
      node.wrenches(state.time, state.y, model_.layout(), std::span(motions_).subspan(first, count),
                    std::span(wrenches_).subspan(first, count), scratch_);
    first += count;
  }
  if (loops_ != nullptr) {
    loops_->multipliers(state.time, state.y, multipliers_, loops_work_);
    loops_->wrenches(multipliers_, std::span(wrenches_).subspan(first), loops_work_);
  }
  for (std::size_t i = 0; i < frames_.size(); ++i)
    if (is_frame(frames_[i])) bodies_[static_cast<std::size_t>(frames_[i].body)].load += wrenches_[i].force;
  for (std::size_t b = bodies_.size(); b-- > 0;) {
    if (const int parent = model_.hinges()[b].parent; parent >= 0)
      bodies_[static_cast<std::size_t>(parent)].load += bodies_[b].load;
  }
}

}  // namespace withy
