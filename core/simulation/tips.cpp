#include "withy/core/simulation/tips.hpp"

#include "withy/core/plugin/measured_place.hpp"

namespace withy {
namespace {

using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Tip tip_of(const Model& model, const std::string& name, const std::string& station, const std::vector<int>& segments) {
  Tip tip;
  tip.body = name;
  tip.station = station;
  tip.at.setZero();
  for (const int b : segments) {
    const BodyNode& node = model.bodies()[static_cast<std::size_t>(b)];
    const int frame = node.frame(station);
    tip.tip = {b, frame};
    tip.at += node.frames[static_cast<std::size_t>(frame)].section.X;
    tip.length += node.body->shape().length;
    tip.flexible = tip.flexible || node.body->shape().modes() > 0;
  }
  tip.root = {segments.front(), 0};
  return tip;
}

std::vector<Tip> ends(const Model& model, bool measured) {
  std::vector<Tip> all;
  for (const BodyNode& node : model.bodies()) {
    const std::string& name = node.scene_name();
    if (node.segment && node.segment->index > 0) continue;
    if (node.frame("tip") >= 0) all.push_back(tip_of(model, name, "tip", model.segments(name)));
    if (!measured || node.segment || node.body->shape().modes() == 0) continue;
    for (const MeasuredPlace& place : measured_places(*node.body))
      if (place.name != "tip" && node.frame(place.name) >= 0)
        all.push_back(tip_of(model, name, place.name, {model.body(name)}));
  }
  return all;
}

}  // namespace

std::vector<Tip> tips(const Model& model) { return ends(model, false); }
std::vector<Tip> measured_ends(const Model& model) { return ends(model, true); }

double section_angle(const Model& model, std::span<const double> y, const Tip& tip) {
  const Slot* slot = model.layout().modes(static_cast<std::size_t>(tip.tip.body));
  if (tip.in_segments() || slot == nullptr) return 0;
  const BodyNode& node = model.bodies()[static_cast<std::size_t>(tip.tip.body)];
  const Matrix3X& psi = node.frames[static_cast<std::size_t>(tip.tip.frame)].section.psi;
  return (psi * Eigen::Map<const Eigen::VectorXd>(y.data() + slot->position, psi.cols())).norm();
}

std::array<double, 3> deflection(const Observation& seen, const Tip& tip) {
  if (!tip.in_segments()) return seen.deflection(tip.tip.body, tip.tip.frame);
  const WorldPose from = seen.frame_pose(tip.root.body, tip.root.frame);
  const WorldPose to = seen.frame_pose(tip.tip.body, tip.tip.frame);
  const Vector3 way = Eigen::Map<const Vector3>(to.position.data()) - Eigen::Map<const Vector3>(from.position.data());
  std::array<double, 3> d{};
  Eigen::Map<Vector3>(d.data()) = Eigen::Map<const Rotation>(from.rotation.data()).transpose() * way - tip.at;
  return d;
}

std::array<double, 3> deflection(const EquationsOfMotion& equations, std::span<const double> y, const Tip& tip) {
  const auto seen = equations.make_observation();
  seen->observe(y);
  return deflection(*seen, tip);
}

}  // namespace withy
