#include "withy/core/simulation/momentum_watch.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"

namespace withy {

bool may_float(const Model& model) {
  bool floats = model.gravity().isZero(0);
  if (const EventBook events(model); events.any())
    for (const std::vector<std::size_t>& locked : events.plan().configurations)
      for (const std::size_t hinge : locked) floats = floats && model.hinges()[hinge].parent >= 0;
  for (std::size_t h = 0; h < model.hinges().size() && floats; ++h) {
    if (model.hinges()[h].parent >= 0) continue;
    const auto kernel = model.hinges()[h].hinge->kernel();
    floats = kernel && kernel->kind == HingeKernel::Kind::free && !model.driven(h);
  }
  // What the bodies of a tree do to each other cancels.
  for (const LoopClosure* loop : loops_of(model)) floats = floats && loop->a().body >= 0 && loop->b().body >= 0;
  return floats;
}

OutsideLoads::OutsideLoads(const Model& model)
    : model_(model), scratch_(model.load_scratch()), efforts_(model.layout().speeds) {
  std::size_t most = 0;
  for (const LoadNode& node : model.loads()) most = std::max(most, node.load->frames().size());
  motions_.resize(most);
  wrenches_.resize(most);
}

bool OutsideLoads::act(double t, std::span<const double> y, const Observation& seen) {
  if (model_.loads().empty()) return false;
  return on_roots(t, y) || std::any_of(model_.loads().begin(), model_.loads().end(), [&](const LoadNode& node) {
           // A field acts on all mass, from outside.
           return acts_on_mass(node) ? acting_field(node, y) != nullptr : by_wrenches_of(node, t, y, seen);
         });
}

bool OutsideLoads::on_roots(double t, std::span<const double> y) {
  const auto positions = y.first(model_.layout().positions);
  const auto speeds = y.subspan(positions.size(), model_.layout().speeds);
  std::fill(efforts_.begin(), efforts_.end(), 0.0);
  for (const LoadNode& node : model_.loads())
    node.load->add(t, positions, speeds, efforts_, std::span(scratch_).first(node.load->scratch()));
  model_.add_state_efforts(t, y, efforts_, scratch_);
  for (std::size_t h = 0; h < model_.hinges().size(); ++h) {
    if (model_.hinges()[h].parent >= 0) continue;
    const Slot& slot = model_.layout().hinges[h];
    for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i)
      if (efforts_[i] != 0) return true;
  }
  return false;
}

bool OutsideLoads::by_wrenches_of(const LoadNode& node, double t, std::span<const double> y, const Observation& seen) {
  constexpr double rounding = 1e-9;  // of what cancels
  const std::span<const FrameIndex> frames = node.load->frames();
  const auto motions = std::span(motions_).first(frames.size());
  const auto wrenches = std::span(wrenches_).first(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const WorldPose pose = seen.frame_pose(frames[i].body, frames[i].frame);
    const WorldVelocity velocity = seen.frame_velocity(frames[i].body, frames[i].frame);
    for (Eigen::Index r = 0; r < 3; ++r)
      for (Eigen::Index c = 0; c < 3; ++c) motions[i].R(r, c) = pose.rotation.at(static_cast<std::size_t>(3 * r + c));
    motions[i].position = vector(pose.position);
    motions[i].angular_velocity = vector(velocity.angular);
    motions[i].velocity = vector(velocity.linear);
  }
  node.wrenches(t, y, model_.layout(), motions, wrenches, scratch_);
  Vector3 force = Vector3::Zero(), moment = Vector3::Zero();  // about the first of its frames
  double forces = 0, moments = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3 arm = motions[i].position - motions[0].position;
    force += wrenches[i].force;
    moment += wrenches[i].moment + arm.cross(wrenches[i].force);
    forces += wrenches[i].force.norm();
    moments += wrenches[i].moment.norm() + arm.norm() * wrenches[i].force.norm();
  }
  return force.norm() > rounding * forces || moment.norm() > rounding * moments;
}

MomentumWatch::MomentumWatch(const Model& model, const EquationsOfMotion& equations, const State& initial,
                             const Energies& e)
    : outside_(model),
      centre_(model, equations, initial.y),
      linear_(vector(e.linear_momentum)),
      angular_(spin(e, centre_.at(initial.y).position)) {}

void MomentumWatch::look(const State& state, const Energies& e, const Observation& seen) {
  look_at_loads(state, seen);
  if (pushed_) return;
  // The mass centre costs as much as three energies.
  constexpr std::size_t every = 8;
  linear_error_ = std::max(linear_error_, (vector(e.linear_momentum) - linear_).norm());
  if (looks_++ % every == 0) look_about_centre(state, e);
}

void MomentumWatch::look_about_centre(const State& state, const Energies& e) {
  const MassCentre::Place centre = centre_.at(state.y);
  const Vector3 linear = vector(e.linear_momentum);
  angular_error_ = std::max(angular_error_, (spin(e, centre.position) - angular_).norm());
  // Of a body that flies without turning, what rounding leaves of the energy is no motion relative to its centre.
  constexpr double rounding = 1e-12;
  const double of_centre = linear.squaredNorm() / (2 * centre_.mass());
  const double relative = std::max(e.kinetic - of_centre, rounding * e.kinetic);
  relative_ = std::max(relative_, relative);
  carried_ = std::max(carried_, 2 * relative * centre.inertia);
}

MomentumDrift MomentumWatch::drift() const {
  MomentumDrift m;
  m.conserved = !pushed_;
  if (pushed_) return m;
  // A tree that does not turn as a whole has no angular momentum to measure by, only what rounding and truncation make
  // of it.
  constexpr double least_share = 0.1;
  const double own = angular_.norm(), most = std::sqrt(carried_);
  m.linear_scale = std::sqrt(2 * centre_.mass() * relative_);
  m.angular_scale = own < least_share * most ? most : own;
  m.linear = m.linear_scale > 0 ? linear_error_ / m.linear_scale : 0;
  m.angular = m.angular_scale > 0 ? angular_error_ / m.angular_scale : 0;
  return m;
}

void MomentumWatch::remember(Memory& memory) {
  memory(pushed_);
  memory(looks_);
  memory(linear_error_);
  memory(angular_error_);
  memory(relative_);
  memory(carried_);
}

}  // namespace withy
