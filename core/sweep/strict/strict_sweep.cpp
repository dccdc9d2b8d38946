#include "withy/core/sweep/strict/strict_sweep.hpp"

#include "withy/core/sweep/first_slopes.hpp"
#include "withy/core/sweep/strict/strict_inverse.hpp"
#include "withy/core/sweep/strict/strict_kernel.hpp"
#include "withy/core/sweep/with_modes.hpp"

namespace withy::sweep {
namespace {

/// J_i of a section at q = 0 and ∂J_i/∂q_k, in section axes.
template <class Space>
StrictStation<Space> strict_station_of(const StationSpec& spec) {
  const PointExpansion& e = spec.at;
  StrictStation<Space> s;
  s.X = Space::position(e.X);
  const Eigen::Index n = e.phi.cols();
  for (Eigen::Index i = 0; i < n; ++i) {
    Vector6 J;
    J << e.psi.col(i), e.phi.col(i);
    s.J.push_back(Space::Twist::of(J));
  }
  s.J1 = first_slopes<Space>(e);
  return s;
}

}  // namespace

template <class Space>
StrictNode<Space>::StrictNode(const NodeSpec& given, Terms terms, const Invariants& invariants)
    : FirstOrderConstants<Space>(given, terms, invariants) {
  for (const RigidInertia& I : invariants.I2) I2.push_back(Variation<Space>::of(I));
  for (const StationSpec& s : rooted(in_strain_order(given, terms.strain)).stations) {
    stations.push_back(strict_station_of<Space>(s));
  }
}

template <class Space>
StrictSweep<Space>::StrictSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity) {
  WorkLayout memory;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    nodes_.emplace_back(tree.nodes[i], terms[i], Invariants(tree.nodes[i], terms[i].strain));
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const NodeSpec& spec = tree.nodes[i];
    if (spec.parent < 0) continue;
    nodes_[static_cast<std::size_t>(spec.parent)].leaf = false;
    if (spec.parent_station < 0) continue;
    const NodeSpec& parent = tree.nodes[static_cast<std::size_t>(spec.parent)];
    nodes_[static_cast<std::size_t>(spec.parent)].stations[static_cast<std::size_t>(spec.parent_station)].has_children =
        true;
    turn_with_root(parent, spec, nodes_[i].joint);
  }
  for (StrictNode<Space>& node : nodes_) {
    const auto n = static_cast<std::size_t>(node.modes);
    speeds_ += node.joint.speeds + n;
    node.work = memory.template take<StrictNodeWork<Space>>(1);
    node.work_stations = memory.template take<StrictStationWork<Space>>(node.stations.size());
    node.work_vectors = memory.template take<typename Space::Twist>(5 * n);
    node.work_scalars = memory.template take<double>(n * n + 2 * n);
  }
  work_size_ = memory.size();
  const Vector3 g = tree.planar ? Vector3(tree.plane.R.transpose() * gravity) : gravity;
  world_acceleration_ = Space::Twist::of(Space::angle(Vector3::Zero()), Space::position(-g));
  for (StrictNode<Space>& node : nodes_) node.joint.pose_matters = node.parent >= 0 || !g.isZero(0);
}

template <class Space>
Evaluation StrictSweep<Space>::accelerations(const double* positions, const double* speeds, double* efforts,
                                             double* result, std::byte* work) const noexcept {
  const StrictState<Space> state{positions, speeds, efforts, result, work, nodes_.data(), &world_acceleration_};
  for (const StrictNode<Space>& node : nodes_) {
    with_modes(node.modes, [&](auto n) { strict_outward<Space, decltype(n)::value>(node, state); });
  }
  int sign = 1;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    int of_node = 0;
    with_modes(nodes_[i].modes, [&](auto n) { of_node = strict_inward<Space, decltype(n)::value>(nodes_[i], state); });
    if (of_node == 0) return {Evaluation::Outcome::singular, nodes_[i].body};
    sign *= of_node;
  }
  for (const StrictNode<Space>& node : nodes_) {
    with_modes(node.modes, [&](auto n) { strict_acceleration<Space, decltype(n)::value>(node, state); });
  }
  return {Evaluation::Outcome::ok, -1, sign};
}

template <class Space>
void StrictSweep<Space>::inverse(const double* positions, const double* speeds, const double* accelerations,
                                 bool inertial, double* efforts, std::byte* work) const noexcept {
  const typename Space::Twist still = Space::Twist::zero();
  // Accelerations go out and efforts come in through one array: a node's own are all that it needs of it.
  std::copy_n(accelerations, speeds_, efforts);
  const StrictState<Space> state{
      positions, speeds, nullptr, efforts, work, nodes_.data(), inertial ? &still : &world_acceleration_};
  for (const StrictNode<Space>& node : nodes_) {
    with_modes(node.modes, [&](auto n) { strict_outward<Space, decltype(n)::value>(node, state); });
    given_acceleration<Space>(node, state);
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) strict_effort<Space>(nodes_[i], state, inertial ? 0.0 : 1.0);
}

template class StrictSweep<Spatial>;
template class StrictSweep<Planar>;

}  // namespace withy::sweep
