#include "withy/results/report/bent_body.hpp"

#include <algorithm>

#include "withy/core/kinematics/observation.hpp"
#include "withy/results/report/seen_pose.hpp"

namespace withy {
namespace {

std::shared_ptr<const Model> alone(const BodyNode& given, const std::shared_ptr<const Hinge>& hinge,
                                   std::span<const PointExpansion> points) {
  BodyNode node{given.name, given.body, {}, given.terms};
  const auto add = [&](const PointExpansion& section) { node.frames.push_back({"", section, {}}); };
  add(PointExpansion::rigid(Vector3::Zero(), node.body->shape().modes()));
  for (const PointExpansion& point : points) add(point);
  HingeNode held;
  held.name = given.name;
  held.hinge = hinge;
  return std::make_shared<const Model>(std::vector{std::move(node)}, std::vector{std::move(held)}, Vector3::Zero());
}

}  // namespace

BentBody::BentBody(const BodyNode& node, const std::shared_ptr<const Hinge>& hinge, const Terms& terms,
                   std::span<const PointExpansion> points)
    : model_(alone(node, hinge, points)),
      seen_(observed_model(*model_, terms)->make_observation()),
      first_(model_->layout().modes(0)->position),
      state_(model_->reference_state()) {}

void BentBody::bend(std::span<const double> q) {
  std::copy(q.begin(), q.end(), state_.y.begin() + static_cast<std::ptrdiff_t>(first_));
  seen_->observe(state_.y);
  X_BW_ = seen_pose(*seen_, 0, 0).inverse();
}

Pose BentBody::section(std::size_t point) const { return X_BW_ * seen_pose(*seen_, 0, static_cast<int>(point) + 1); }

}  // namespace withy
