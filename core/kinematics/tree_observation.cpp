#include "withy/core/kinematics/tree_observation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

double size_of(double w) { return std::abs(w); }
double size_of(const Spatial::Position& w) { return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]); }

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
Energies energies_of(const Tree<Space>& tree, const Sums<Space>& sums, double strain) noexcept {
  const Matrix3& R = tree.plane.R;
  Energies e;
  e.kinetic = sums.kinetic;
  e.potential = tree.fixed_potential + strain - tree.gravity.dot(lifted(sums.moment, tree.height_moment));
  e.linear_momentum = array(R * lifted(linear(sums.momentum), 0));
  e.angular_momentum = array(R * lifted_angular(sums.momentum, sums.across));
  return e;
}
template Energies energies_of(const Tree<Planar>& tree, const Sums<Planar>& sums, double strain) noexcept;
template Energies energies_of(const Tree<Spatial>& tree, const Sums<Spatial>& sums, double strain) noexcept;

template <class Space>
TreeObservation<Space>::TreeObservation(std::shared_ptr<const Tree<Space>> tree)
    : tree_(std::move(tree)), pass_(tree_->nodes, tree_->size, tree_->positions) {}

template <class Space>
void TreeObservation<Space>::observe(std::span<const double> y) noexcept {
  std::copy(y.begin(), y.end(), pass_.y().begin());
  behind_ = true;
}

template <class Space>
const TreePass<Space>& TreeObservation<Space>::moved() const noexcept {
  if (std::exchange(behind_, false)) pass_.move();
  return pass_;
}

template <class Space>
Energies TreeObservation<Space>::energies() const noexcept {
  return energies_of(*tree_, moved().sums(), pass_.strain_energy());
}

template <class Space>
WorldPose TreeObservation<Space>::frame_pose(int body, int frame) const noexcept {
  const FramePlace& at = tree_->frame(body, frame);
  Pose X = at.pose;
  if (at.node >= 0) {
    const Moving<Space> A = moved().motion_at(at.node, at.station);
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
  const Moving<Space> A = moved().motion_at(at.node, at.station);
  const typename Space::Twist V = Space::shift_to_child(Space::position(at.pose.p), A.V);
  const Matrix3 R = tree_->plane.R * matrix(A.X.R);
  const typename Space::Position none = Space::Position::zero();
  return {array(R * lifted_angular(V, none)), array(R * lifted(linear(V), 0))};
}

template <class Space>
double TreeObservation<Space>::turning(int body) const noexcept {
  const BodyAxes& axes = tree_->bodies[static_cast<std::size_t>(body)];
  return axes.node < 0 ? 0 : size_of(moved().motion_at(axes.node, axes.station).V.w);
}

template <class Space>
std::array<double, 3> TreeObservation<Space>::deflection(int body, int frame) const noexcept {
  const FramePlace& at = tree_->frame(body, frame);
  const BodyAxes& axes = tree_->bodies[static_cast<std::size_t>(body)];
  if (!axes.flexible || at.station < 0) return {};
  const Node<Space>& node = tree_->nodes[static_cast<std::size_t>(at.node)];
  const auto k = static_cast<std::size_t>(at.station);
  const typename Space::Position& X = node.is_rod() ? node.rod.stations[k].X : node.stations[k].fields.X;
  if (behind_) pass_.bend(node);
  const typename Space::Position d = difference(pass_.section(node, at.station).frame.p, X);
  return array(axes.R.transpose() * lifted(d, 0));
}

template <class Space>
bool TreeObservation<Space>::expands(int body) const noexcept {
  return tree_->bodies[static_cast<std::size_t>(body)].expanded;
}

template class TreeObservation<Planar>;
template class TreeObservation<Spatial>;

}  // namespace withy::observed
