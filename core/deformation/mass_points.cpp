#include "withy/core/deformation/mass_points.hpp"

#include "withy/core/deformation/rod_table.hpp"
#include "withy/core/model/switched_load.hpp"

namespace withy {
namespace {

/// Σ m ρ ρᵀ of an inertia Σ m (ρ·ρ 1 − ρ ρᵀ).
Matrix3 second_moment(const Matrix3& inertia) { return 0.5 * inertia.trace() * Matrix3::Identity() - inertia; }

const FieldLoad* first_field(const LoadNode& node) {
  if (const auto* field = dynamic_cast<const FieldLoad*>(node.load.get())) return field;
  const auto* switched = dynamic_cast<const LoadOfForms*>(node.load.get());
  return switched == nullptr ? nullptr : dynamic_cast<const FieldLoad*>(&switched->first());
}

}  // namespace

std::vector<MassPoint> mass_points(const Body& body) {
  std::vector<MassPoint> points;
  if (const Rod* rod = body.rod()) {
    const RodTable table(*rod);
    for (std::size_t k = 0; k < table.sections.size(); ++k) {
      points.push_back(
          {table.masses[k], second_moment(table.inertias[k]), body.station(table.quadrature.nodes()[k]).value()});
    }
    return points;
  }
  return mass_points(body.shape().particles, body.shape().sections, body.shape().modes());
}

std::vector<MassPoint> mass_points(const std::vector<Particle>& particles, const std::vector<Section>& sections,
                                   Eigen::Index modes) {
  std::vector<MassPoint> points;
  for (const Particle& p : particles) points.push_back({p.mass, Matrix3::Zero(), p.at});
  for (const Section& s : sections) points.push_back({0, second_moment(s.inertia), s.at});
  if (modes > 0 || points.size() < 2) return points;
  MassPoint center{.mass = 0, .second = Matrix3::Zero(), .at = points.front().at};
  Vector3 moment = Vector3::Zero();
  for (const MassPoint& p : points) {
    center.mass += p.mass;
    moment += p.mass * p.at.X;
  }
  if (!(center.mass > 0)) return points;
  if (particles.size() > 1) center.at.X = moment / center.mass;
  for (const MassPoint& p : points) {
    const Vector3 arm = p.at.X - center.at.X;
    center.second += p.second + p.mass * arm * arm.transpose();
  }
  return {center};
}

std::vector<double> mass_beyond(const Body& body, double x) {
  const Rod* rod = body.rod();
  if (rod == nullptr) return {};
  return RodTable(*rod).beyond(x).shares;
}

FieldLoad::FieldLoad(const Model& model) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    bodies_.push_back(model.bodies()[b].body);
    first_.push_back(points_.size());
    for (MassPoint& point : mass_points(*bodies_.back())) {
      frames_.push_back({static_cast<int>(b), -1 - static_cast<int>(points_.size() - first_.back())});
      points_.push_back(std::move(point));
    }
  }
  first_.push_back(points_.size());
}

const MassPoint& FieldLoad::point(FrameIndex at) const {
  return points_of(at.body)[static_cast<std::size_t>(-1 - at.frame)];
}

std::span<const MassPoint> FieldLoad::points_of(int body) const {
  const auto b = static_cast<std::size_t>(body);
  return std::span(points_).subspan(first_[b], first_[b + 1] - first_[b]);
}

bool FieldLoad::is_of(const Model& model) const {
  bool same = model.bodies().size() == bodies_.size();
  for (std::size_t b = 0; same && b < bodies_.size(); ++b) same = model.bodies()[b].body == bodies_[b];
  return same;
}

void FieldLoad::wrenches(double t, std::span<const FrameMotion> motions, std::span<Wrench> wrenches) const noexcept {
  for (std::size_t k = 0; k < points_.size(); ++k) wrenches[k] = wrench(t, points_[k], motions[k]);
}

const FieldLoad* field_of(const Model& model) {
  for (const LoadNode& node : model.loads())
    if (const FieldLoad* field = first_field(node)) return field;
  return nullptr;
}

bool acts_on_mass(const LoadNode& node) { return first_field(node) != nullptr; }

const FieldLoad* acting_field(const LoadNode& node, std::span<const double> y) noexcept {
  if (const auto* field = dynamic_cast<const FieldLoad*>(node.load.get())) return field;
  const auto* switched = dynamic_cast<const LoadOfForms*>(node.load.get());
  return switched == nullptr ? nullptr : dynamic_cast<const FieldLoad*>(switched->acting(node.discrete(y)));
}

ActingFields::ActingFields(const Model& model) {
  for (const LoadNode& node : model.loads())
    if (acts_on_mass(node)) loads_.push_back(&node);
}

Vector3 ActingFields::acceleration(double t, std::span<const double> y, const FrameMotion& motion) const noexcept {
  Vector3 sum = Vector3::Zero();
  for (const LoadNode* node : loads_)
    if (const FieldLoad* field = acting_field(*node, y)) sum += field->acceleration(t, motion);
  return sum;
}

Wrench ActingFields::wrench(double t, std::span<const double> y, const MassPoint& point,
                            const FrameMotion& motion) const noexcept {
  Wrench sum;
  for (const LoadNode* node : loads_) {
    const FieldLoad* field = acting_field(*node, y);
    if (field == nullptr) continue;
    const Wrench own = field->wrench(t, point, motion);
    sum.moment += own.moment;
    sum.force += own.force;
  }
  return sum;
}

FramePlace place_of(const Model& model, FrameIndex at) {
  if (at.frame < 0) return {field_of(model)->point(at).at, Pose{}};
  const Frame& frame = model.bodies()[static_cast<std::size_t>(at.body)].frames[static_cast<std::size_t>(at.frame)];
  return {frame.section, frame.pose};
}

bool has_place(const Model& model, FrameIndex at) {
  if (at.body < 0 || static_cast<std::size_t>(at.body) >= model.bodies().size()) return false;
  const auto count = [](std::size_t size) { return static_cast<std::ptrdiff_t>(size); };
  if (at.frame >= 0) return at.frame < count(model.bodies()[static_cast<std::size_t>(at.body)].frames.size());
  const FieldLoad* field = field_of(model);
  return field != nullptr && -1 - at.frame < count(field->points_of(at.body).size());
}

std::string frame_in_words(const Model& model, FrameIndex at) {
  const bool known = at.body >= 0 && static_cast<std::size_t>(at.body) < model.bodies().size();
  return "frame " + std::to_string(at.frame) + " of body " +
         (known ? "'" + model.bodies()[static_cast<std::size_t>(at.body)].name + "'" : std::to_string(at.body));
}

}  // namespace withy
