#include "withy/core/sweep/first_order/first_order_sweep.hpp"

#include <algorithm>

#include "withy/core/sweep/first_order/first_order_inverse.hpp"
#include "withy/core/sweep/first_order/first_order_kernel.hpp"
#include "withy/core/sweep/first_slopes.hpp"
#include "withy/core/sweep/with_modes.hpp"

namespace withy::sweep {

template <class Space>
FirstOrderNode<Space>::FirstOrderNode(const NodeSpec& given, Terms terms, const Invariants& invariants)
    : FirstOrderConstants<Space>(given, terms, invariants), mass(invariants.I0.mass) {
  for (const RigidInertia& I : invariants.I1) moment1.push_back(Space::position(I.moment));
  for (const RigidInertia& I : invariants.I2) moment2.push_back(Space::position(I.moment));
  const std::vector<Eigen::MatrixXd> slopes = modal_mass_slopes(given, terms.strain);
  const auto n = static_cast<Eigen::Index>(given.modes);
  for (const Eigen::MatrixXd& slope : slopes) {
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index k = 0; k < n; ++k) G1.push_back(slope(j, k));
    }
  }
  for (const StationSpec& spec : rooted(in_strain_order(given, terms.strain)).stations) {
    FirstOrderStation<Space> station;
    station.fields = Fields<Space>(spec.at);
    station.J = station.fields.first;
    station.J1 = first_slopes<Space>(spec.at);
    stations.push_back(std::move(station));
  }
}

template <class Space>
FirstOrderSweep<Space>::FirstOrderSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    nodes_.emplace_back(tree.nodes[i], terms[i], Invariants(tree.nodes[i], terms[i].strain));
  }
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const NodeSpec& spec = tree.nodes[i];
    if (spec.parent < 0) continue;
    FirstOrderNode<Space>& parent = nodes_[static_cast<std::size_t>(spec.parent)];
    parent.mass += nodes_[i].mass;
    if (spec.parent_station < 0) continue;
    FirstOrderStation<Space>& station = parent.stations[static_cast<std::size_t>(spec.parent_station)];
    station.has_children = true;
    station.carried += nodes_[i].mass;
    turn_with_root(tree.nodes[static_cast<std::size_t>(spec.parent)], spec, nodes_[i].joint);
  }
  WorkLayout memory;
  std::size_t speeds = 0;
  for (FirstOrderNode<Space>& node : nodes_) {
    const auto n = static_cast<std::size_t>(node.modes);
    speeds = std::max({speeds, node.joint.speed + node.joint.speeds, node.mode_speed + n});
    node.work = memory.template take<FirstOrderNodeWork<Space>>(1);
    node.work_stations = memory.template take<FirstOrderStationWork<Space>>(node.stations.size());
    node.work_J1 = memory.template take<typename Space::Twist>(n * node.stations.size());
    node.work_Y = memory.template take<Orders<Space>>(n);
    node.work_G = memory.template take<double>(n * n);
    node.work_y = memory.template take<double>(n);
    if (!single(node.joint.kind) && node.joint.kind != Joint::fixed)
      node.work_elimination = memory.template take<FirstOrderElimination<Space>>(1);
  }
  const Vector3 g = tree.planar ? Vector3(tree.plane.R.transpose() * gravity) : gravity;
  gravity_ = Space::position(g);
  heavy_ = !g.isZero(0);
  speeds_ = speeds;
  weight_offset_ = memory.template take<double>(heavy_ ? 2 * speeds : 0);
  work_size_ = memory.size();
  for (FirstOrderNode<Space>& node : nodes_) node.joint.pose_matters = node.parent >= 0 || heavy_;
}

template <class Space>
void FirstOrderSweep<Space>::find_weight(const FirstOrderState<Space>& state, double* weight) const noexcept {
  for (const FirstOrderNode<Space>& node : nodes_) weight::outward<Space>(node, state, gravity_);
  for (std::size_t i = nodes_.size(); i-- > 0;) weight::inward<Space>(nodes_[i], state, weight);
}

template <class Space>
Evaluation FirstOrderSweep<Space>::inward(const FirstOrderState<Space>& state) const noexcept {
  int sign = 1;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    int of_node = 0;
    with_modes(nodes_[i].modes, [&](auto n) { of_node = first_order_inward<Space, n.value>(nodes_[i], state); });
    if (of_node == 0) return {Evaluation::Outcome::singular, nodes_[i].body};
    sign *= of_node;
  }
  return {Evaluation::Outcome::ok, -1, sign};
}

template <class Space>
void FirstOrderSweep<Space>::outward(const FirstOrderState<Space>& state) const noexcept {
  for (const FirstOrderNode<Space>& node : nodes_) {
    with_modes(node.modes, [&](auto n) { first_order_acceleration<Space, n.value>(node, state); });
  }
}

template <class Space>
void FirstOrderSweep<Space>::move(const FirstOrderState<Space>& state) const noexcept {
  for (const FirstOrderNode<Space>& node : nodes_) {
    with_modes(node.modes, [&](auto n) { first_order_outward<Space, n.value>(node, state); });
  }
}

template <class Space>
Evaluation FirstOrderSweep<Space>::accelerations(const double* positions, const double* speeds, double* efforts,
                                                 double delta, double* result, std::byte* work) const noexcept {
  FirstOrderState<Space> state{positions, speeds, efforts, result, work, nodes_.data(), delta, efforts};
  move(state);
  if (heavy_) {
    auto* weight = at<double>(work, weight_offset_);
    find_weight(state, weight);
    double* all = weight + speeds_;
    for (std::size_t i = 0; i < speeds_; ++i) all[i] = efforts[i] + weight[i];
    state.efforts = all;
    state.weight = weight;
  }
  const Evaluation evaluation = inward(state);
  if (evaluation.ok()) outward(state);
  return evaluation;
}

// In the frame of a root gravity has order zero alone, and all that hangs on it is in its first moment of mass.
template <class Space>
double FirstOrderSweep<Space>::weight_potential(const double* positions, const double* at_rest,
                                                std::byte* work) const noexcept {
  if (!heavy_) return 0;
  const FirstOrderState<Space> state{positions, at_rest, at_rest, nullptr, work, nodes_.data()};
  move(state);
  find_weight(state, at<double>(work, weight_offset_));
  double potential = 0;
  for (const FirstOrderNode<Space>& node : nodes_) {
    if (node.parent >= 0) continue;
    const auto& root = *at<FirstOrderNodeWork<Space>>(work, node.work);
    potential -= node.mass * weight::scalar(gravity_, root.SM.p);
    for (std::size_t order = 0; order < 3; ++order) potential -= weight::scalar(root.g[0], root.s[order]);
  }
  return potential;
}

template <class Space>
Evaluation FirstOrderSweep<Space>::factorize(const double* positions, const double* at_rest, double delta,
                                             std::byte* work) const noexcept {
  const FirstOrderState<Space> state{positions, at_rest, at_rest, nullptr, work, nodes_.data(), delta};
  move(state);
  return inward(state);
}

template <class Space>
void FirstOrderSweep<Space>::solve(const double* forces, double delta, double* result, std::byte* work) const noexcept {
  const FirstOrderState<Space> state{nullptr, nullptr, forces, result, work, nodes_.data(), delta};
  for (const FirstOrderNode<Space>& node : nodes_) {
    at<FirstOrderNodeWork<Space>>(work, node.work)->p = Orders<Space>::none();
    auto* stations = at<FirstOrderStationWork<Space>>(work, node.work_stations);
    for (std::size_t k = 0; k < node.stations.size(); ++k) stations[k].p = Orders<Space>::none();
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) first_order_force<Space>(nodes_[i], state);
  outward(state);
}

template <class Space>
void FirstOrderSweep<Space>::inverse(const double* positions, const double* speeds, const double* accelerations,
                                     bool inertial, double* efforts, std::byte* work) const noexcept {
  const FirstOrderState<Space> state{positions, speeds, accelerations, efforts, work, nodes_.data()};
  move(state);
  for (const FirstOrderNode<Space>& node : nodes_) given_acceleration<Space>(node, state);
  for (std::size_t i = nodes_.size(); i-- > 0;) first_order_effort<Space>(nodes_[i], state, inertial ? 0.0 : 1.0);
  if (inertial || !heavy_) return;
  auto* weight = at<double>(work, weight_offset_);
  find_weight(state, weight);
  for (std::size_t i = 0; i < speeds_; ++i) efforts[i] -= weight[i];
}

template class FirstOrderSweep<Spatial>;
template class FirstOrderSweep<Planar>;

}  // namespace withy::sweep
