#include "withy/core/kinematics/tree_observation.hpp"

#include <algorithm>

#include "withy/core/kinematics/observed_mass.hpp"

namespace withy::observed {
namespace {

Vector3 lifted(const Planar::Position& p, double height) { return {p.x, p.y, height}; }
Vector3 lifted(const Spatial::Position& p, double /*height*/) { return {p[0], p[1], p[2]}; }
Vector3 lifted_angular(const Planar::Twist& V, const Planar::Position& across) { return {across.x, across.y, V.w}; }
Vector3 lifted_angular(const Spatial::Twist& V, const Spatial::Position& /*across*/) {
  return {V.w[0], V.w[1], V.w[2]};
}
Planar::Position linear(const Planar::Twist& V) { return {V.x, V.y}; }
Spatial::Position linear(const Spatial::Twist& V) { return V.v; }

Matrix3 matrix(const Planar::Rotation& R) {
  Matrix3 m = Matrix3::Identity();
  m.topLeftCorner<2, 2>() << R.c, -R.s, R.s, R.c;
  return m;
}
Matrix3 matrix(const Block& R) {
  Matrix3 m;
  for (int j = 0; j < 3; ++j) m.col(j) << R(0, j), R(1, j), R(2, j);
  return m;
}

std::array<double, 3> array(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Planar::Position difference(const Planar::Position& a, const Planar::Position& b) { return {a.x - b.x, a.y - b.y}; }
Spatial::Position difference(const Spatial::Position& a, const Spatial::Position& b) { return a - b; }

}  // namespace

template <class Space>
TreeObservation<Space>::TreeObservation(std::shared_ptr<const Tree<Space>> tree)
    : tree_(std::move(tree)),
      y_(tree_->size),
      nodes_(tree_->nodes.size()),
      stations_(tree_->stations),
      rods_(tree_->rod_packs),
      particles_(tree_->most_modes * Space::linear),
      partials_(tree_->most_modes) {}

template <class Space>
void TreeObservation<Space>::observe(std::span<const double> y) noexcept {
  std::copy(y.begin(), y.end(), y_.begin());
  for (std::size_t i = 0; i < nodes_.size(); ++i) move(i);
}

template <class Space>
void TreeObservation<Space>::move(std::size_t index) noexcept {
  const Node<Space>& node = tree_->nodes[index];
  if (node.is_rod()) sweep::rod_motion<any_count>(node.rod, node.modes, q(node), q_dot(node), rod(node));
  sweep::JointMotion<Space> joint;
  sweep::joint_motion<Space>(node.joint, y_.data() + node.joint.position,
                             y_.data() + tree_->positions + node.joint.speed, joint);
  Motion& B = nodes_[index];
  B = {joint.SM, joint.rate};
  if (node.parent >= 0) {
    const Node<Space>& parent = tree_->nodes[static_cast<std::size_t>(node.parent)];
    const Motion& outer = node.parent_station < 0
                              ? nodes_[static_cast<std::size_t>(node.parent)]
                              : stations_[parent.first_station + static_cast<std::size_t>(node.parent_station)];
    B.X = Space::compose(outer.X, joint.SM);
    B.V += Space::to_child(joint.SM, outer.V);
  }
  if (node.root_station >= 0) {
    const sweep::StationMotion<Space> root = section(node, node.root_station);
    const typename Space::Frame BM = Space::compose(root.frame, node.M);
    B.V = Space::from_child(BM, B.V - Space::to_child(node.M, root.rate));
    B.X = Space::compose(B.X, Space::inverse(BM));
  }
  for (std::size_t k = 0; k < node.stations.size() && node.stations[k].needed; ++k) {
    const sweep::StationMotion<Space> m = section(node, static_cast<int>(k));
    stations_[node.first_station + k] = {Space::compose(B.X, m.frame), Space::to_child(m.frame, B.V) + m.rate};
  }
}

template <class Space>
sweep::StationMotion<Space> TreeObservation<Space>::section(const Node<Space>& node, int station) const noexcept {
  sweep::StationMotion<Space> m;
  const auto k = static_cast<std::size_t>(station);
  if (node.is_rod()) {
    sweep::rod_station_motion<any_count>(node.rod, k, rod(node), node.modes, q(node), q_dot(node), m, partials_.data());
  } else {
    sweep::station_motion<Space, any_count>(node.stations[k].fields, node.modes, q(node), q_dot(node), m,
                                            partials_.data());
  }
  return m;
}

template <class Space>
Moving<Space> TreeObservation<Space>::motion_at(int index, int station) const noexcept {
  const Motion& B = nodes_[static_cast<std::size_t>(index)];
  if (station < 0) return B;
  const Node<Space>& node = tree_->nodes[static_cast<std::size_t>(index)];
  const auto k = static_cast<std::size_t>(station);
  if (node.stations[k].needed) return stations_[node.first_station + k];
  const sweep::StationMotion<Space> m = section(node, station);
  return {Space::compose(B.X, m.frame), Space::to_child(m.frame, B.V) + m.rate};
}

template <class Space>
void TreeObservation<Space>::add_flexible(std::size_t index, Sums<Space>& sums) const noexcept {
  const Node<Space>& node = tree_->nodes[index];
  const Motion& B = nodes_[index];
  PartMomentum<Space> part;
  if (node.is_rod()) {
    add_rod(node.rod, rod(node), node.modes, q_dot(node), B.V, part);
  } else {
    add_mass<Space>(node.mass, node.modes, q(node), q_dot(node), B.V, particles_.data(), part);
    add_sections(node.rotary, node.modes, q(node), q_dot(node), B.V, part);
  }
  add_part<Space>(B.X, part.h, part.moment, part.mass, part.kinetic, node.flexible_height, sums);
}

template <class Space>
double TreeObservation<Space>::strain_energy() const noexcept {
  double energy = 0;
  for (const Node<Space>& node : tree_->nodes) {
    const double* x = q(node);
    const double* K = node.stiffness.data();
    for (int i = 0; i < node.modes; ++i) {
      double force = 0;
      for (int j = 0; j < node.modes; ++j) force += *K++ * x[j];
      energy += 0.5 * x[i] * force;
    }
  }
  return energy;
}

template <class Space>
Energies TreeObservation<Space>::energies() const noexcept {
  Sums<Space> sums;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node<Space>& node = tree_->nodes[i];
    add_fixed(node.base, nodes_[i], sums);
    for (std::size_t k = 0; k < node.stations.size() && node.stations[k].needed; ++k)
      add_fixed(node.stations[k].carried, stations_[node.first_station + k], sums);
    if (node.modes > 0) add_flexible(i, sums);
  }
  const Matrix3& R = tree_->plane.R;
  Energies e;
  e.kinetic = sums.kinetic;
  e.potential =
      tree_->fixed_potential + strain_energy() - tree_->gravity.dot(lifted(sums.moment, tree_->height_moment));
  e.linear_momentum = array(R * lifted(linear(sums.momentum), 0));
  e.angular_momentum = array(R * lifted_angular(sums.momentum, sums.across));
  return e;
}

template <class Space>
WorldPose TreeObservation<Space>::frame_pose(int body, int frame) const noexcept {
  const FramePlace& at = tree_->frame(body, frame);
  Pose X = at.pose;
  if (at.node >= 0) {
    const Motion A = motion_at(at.node, at.station);
    const Matrix3& R = tree_->plane.R;
    X.R = R * (matrix(A.X.R) * at.pose.R);
    X.p = R * lifted(A.X.p + Space::rotate(A.X.R, Space::position(at.pose.p)), at.height);
  }
  WorldPose pose;
  pose.position = array(X.p);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data()) = X.R;
  return pose;
}

template <class Space>
WorldVelocity TreeObservation<Space>::frame_velocity(int body, int frame) const noexcept {
  const FramePlace& at = tree_->frame(body, frame);
  if (at.node < 0) return {};
  const Motion A = motion_at(at.node, at.station);
  const Twist V = Space::shift_to_child(Space::position(at.pose.p), A.V);
  const Matrix3 R = tree_->plane.R * matrix(A.X.R);
  const typename Space::Position none = Space::Position::zero();
  return {array(R * lifted_angular(V, none)), array(R * lifted(linear(V), 0))};
}

template <class Space>
std::array<double, 3> TreeObservation<Space>::deflection(int body, int frame) const noexcept {
  const FramePlace& at = tree_->frame(body, frame);
  const BodyAxes& axes = tree_->bodies[static_cast<std::size_t>(body)];
  if (!axes.flexible || at.station < 0) return {};
  const Node<Space>& node = tree_->nodes[static_cast<std::size_t>(at.node)];
  const auto k = static_cast<std::size_t>(at.station);
  const typename Space::Position& X = node.is_rod() ? node.rod.stations[k].X : node.stations[k].fields.X;
  const typename Space::Position d = difference(section(node, at.station).frame.p, X);
  return array(axes.R.transpose() * lifted(d, 0));
}

template class TreeObservation<Planar>;
template class TreeObservation<Spatial>;

}  // namespace withy::observed
