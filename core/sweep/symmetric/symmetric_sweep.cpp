#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "withy/core/sweep/symmetric/shared_bodies.hpp"
#include "withy/core/sweep/symmetric/symmetric_inverse.hpp"
#include "withy/core/sweep/symmetric/symmetric_kernel.hpp"
#include "withy/core/sweep/symmetric/symmetric_layout.hpp"
#include "withy/core/tree/twins.hpp"

namespace withy::sweep {
namespace {

std::vector<double> row_major(const Eigen::MatrixXd& m) {
  std::vector<double> a;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) a.push_back(m(i, j));
  }
  return a;
}

/// The mass of a node that is not frozen.
template <class Space>
void take_mass(const NodeSpec& spec, Terms terms, const SymmetricBody<Space>* twin, SymmetricNode<Space>& node,
               SymmetricBody<Space>& body) {
  if (terms.strain == StrainOrder::exact && node.modes > 0) {
    body.rod = twin != nullptr && !twin->rod.empty() && twin->rod->fits(spec) ? twin->rod : RodKinematics<Space>(spec);
    node.flavor = body.rod->integrals.packs > 0 ? Flavor::exact : Flavor::full;
    return;
  }
  node.flavor = node.modes > 0 ? Flavor::full : Flavor::rigid;
  body.mass = twin != nullptr ? twin->mass : MassTable<Space>(spec);
  body.rotary = twin != nullptr ? twin->rotary : RotaryTable<Space>(spec);
}

/// The mass of a frozen node.
template <class Space>
void freeze(const Invariants& invariants, SymmetricBody<Space>& body) {
  body.base = RigidPart<Space>(invariants.I0);
  body.G0 = row_major(invariants.G0);
  std::vector<typename Space::Twist> coupling;
  std::vector<Variation<Space>> inertias;
  for (Eigen::Index i = 0; i < invariants.C0.cols(); ++i) {
    coupling.push_back(Space::Twist::of(invariants.C0.col(i)));
    inertias.push_back(Variation<Space>::of(invariants.I1[static_cast<std::size_t>(i)]));
  }
  body.C0 = std::move(coupling);
  body.I1 = std::move(inertias);
}

/// Takes from a twin what is equal.
template <class Space>
void share(const SymmetricBody<Space>& twin, SymmetricBody<Space>& body) {
  body.stiffness.share(twin.stiffness);
  body.damping.share(twin.damping);
  body.C0.share(twin.C0);
  body.G0.share(twin.G0);
  body.I1.share(twin.I1);
  for (std::size_t k = 0; k < std::min(body.stations.size(), twin.stations.size()); ++k) {
    body.stations[k].fields.share(twin.stations[k].fields);
    body.stations[k].J.share(twin.stations[k].J);
  }
}

}  // namespace

template <class Space>
SymmetricNode<Space>::SymmetricNode(const NodeSpec& given, Terms terms, const SymmetricNode* twin)
    : body(given.body),
      parent(given.parent),
      parent_station(given.parent_station),
      modes(static_cast<int>(given.modes)),
      mode_position(given.mode_position),
      mode_speed(given.mode_speed),
      joint(given) {
  const bool frozen = terms.truncation == Truncation::ruthless && given.modes > 0;
  NodeSpec spec = in_strain_order(given, terms.strain);
  if (frozen) spec = rooted(std::move(spec));
  root_station = spec.root_station;
  SymmetricBody<Space> made;
  made.stiffness = row_major(given.stiffness);
  made.damping = row_major(given.damping);
  if (root_station >= 0) made.M = Space::make(spec.M);
  made.base = RigidPart<Space>(spec.base);
  for (const StationSpec& s : spec.stations) {
    SymmetricStation<Space> station;
    station.fields = Fields<Space>(s.at);
    station.J = station.fields.first;
    if (!frozen) {
      station.carried = RigidPart<Space>(s.carried);
      station.loaded = !s.carried.empty();
    }
    made.stations.push_back(std::move(station));
  }
  if (frozen) {
    flavor = Flavor::frozen;
    freeze(Invariants(given, terms.strain), made);
  } else {
    take_mass(spec, terms, twin != nullptr ? &*twin->own : nullptr, *this, made);
  }
  if (twin != nullptr) share(*twin->own, made);
  own = std::move(made);
}

template <class Space>
SymmetricSweep<Space>::SymmetricSweep(const NodeTree& tree, const std::vector<Terms>& terms, const Vector3& gravity) {
  nodes_.reserve(tree.nodes.size());
  Twins twins;
  RigidParts<Space> parts;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const std::optional<std::size_t> twin = twins.of(tree.nodes[i], terms[i].strain, terms[i].truncation);
    SymmetricNode<Space>& node = nodes_.emplace_back(tree.nodes[i], terms[i], twin ? &nodes_[*twin] : nullptr);
    node.own.edit([&](SymmetricBody<Space>& body) {
      parts.share(body.base);
      for (SymmetricStation<Space>& station : body.stations) parts.share(station.carried);
    });
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    SymmetricNode<Space>& node = nodes_[i];
    const NodeSpec& spec = tree.nodes[i];
    if (spec.parent < 0) continue;
    SymmetricNode<Space>& parent = nodes_[static_cast<std::size_t>(spec.parent)];
    const NodeSpec& parent_spec = tree.nodes[static_cast<std::size_t>(spec.parent)];
    parent.leaf = false;
    if (spec.parent_station < 0) {
      parent.has_children = true;
    } else {
      parent.own.edit([&](SymmetricBody<Space>& body) {
        SymmetricStation<Space>& station = body.stations[static_cast<std::size_t>(spec.parent_station)];
        station.loaded = station.has_children = true;
      });
      // Rooting turned the section's axes with the frame.
      if (parent.flavor == Flavor::frozen && parent_spec.root_station >= 0) {
        node.joint.F = Space::make(Pose{parent_spec.M.R.transpose(), Vector3::Zero()} * spec.F);
      }
    }
  }
  for (SymmetricNode<Space>& node : nodes_)
    if (node.flavor == Flavor::frozen && node.leaf) precompute(node);
  work_size_ = lay_out(nodes_);
  share_bodies(nodes_);
  const Vector3 g = tree.planar ? Vector3(tree.plane.R.transpose() * gravity) : gravity;
  world_acceleration_ = Space::Twist::of(Space::angle(Vector3::Zero()), Space::position(-g));
  for (SymmetricNode<Space>& node : nodes_) node.joint.pose_matters = node.parent >= 0 || !g.isZero(0);
}

template <class Space>
std::vector<std::string> SymmetricSweep<Space>::savings(const NodeTree& tree) const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const SymmetricNode<Space>& node = nodes_[i];
    const std::string name = "'" + tree.nodes[i].name + "': ";
    if (!node.own->factor.empty()) {
      lines.push_back(name + "its modes are eliminated once for all evaluations: nothing hangs on it");
    } else if (node.flavor == Flavor::frozen) {
      lines.push_back(name + "mass integrals are those of the undeformed body, computed once");
    } else if (node.own->mass.packs > 0) {
      lines.push_back(name + std::to_string(tree.nodes[i].mass.size()) + " mass points became " +
                      std::to_string(node.own->mass.rank) + " generalized particles");
    }
    if (node.own->rotary.packs > 0)
      lines.push_back(name + std::to_string(node.own->rotary.sections) +
                      " sections with rotary inertia are evaluated four at a time");
  }
  return lines;
}

template <class Space>
[[gnu::noinline]] void SymmetricSweep<Space>::outward_motions(const SymmetricState<Space>& state,
                                                              NodeRange nodes) noexcept {
  for (std::size_t i = nodes.first; i < nodes.end; ++i) {
    const SymmetricNode<Space>& node = state.nodes[i];
    with_flavor(node, [&](auto n, auto flavor) { outward_motion<Space, n.value, flavor.value>(node, state); });
  }
}

template <class Space>
[[gnu::noinline]] const SymmetricNode<Space>* SymmetricSweep<Space>::inward_inertias(const SymmetricState<Space>& state,
                                                                                     NodeRange nodes) noexcept {
  for (std::size_t i = nodes.end; i-- > nodes.first;) {
    const SymmetricNode<Space>& node = state.nodes[i];
    bool good = true;
    with_flavor(node, [&](auto n, auto flavor) { good = inward_inertia<Space, n.value, flavor.value>(node, state); });
    if (!good) return &node;
  }
  return nullptr;
}

template <class Space>
[[gnu::noinline]] void SymmetricSweep<Space>::outward_accelerations(const SymmetricState<Space>& state,
                                                                    NodeRange nodes) noexcept {
  for (std::size_t i = nodes.first; i < nodes.end; ++i) {
    const SymmetricNode<Space>& node = state.nodes[i];
    with_flavor(node, [&](auto n, auto flavor) { outward_acceleration<Space, n.value, flavor.value>(node, state); });
  }
}

template <class Space>
Evaluation SymmetricSweep<Space>::accelerations(const SymmetricState<Space>& state, NodeRange nodes) noexcept {
  outward_motions(state, nodes);
  if (const SymmetricNode<Space>* const unsolved = inward_inertias(state, nodes)) return singular_at(unsolved->body);
  outward_accelerations(state, nodes);
  return all_solved;
}

template <class Space>
Evaluation SymmetricSweep<Space>::accelerations(const double* positions, const double* speeds, double* efforts,
                                                double delta, double* result, std::byte* work) const noexcept {
  const SymmetricState<Space> state{positions, speeds, efforts, result, work, nodes_.data(), &world_acceleration_,
                                    delta,     efforts};
  return accelerations(state, all());
}

template <class Space>
Evaluation SymmetricSweep<Space>::factorize(const double* positions, const double* at_rest, double delta,
                                            std::byte* work) const noexcept {
  const SymmetricState<Space> state{positions, at_rest, at_rest, nullptr, work, nodes_.data(), &world_acceleration_,
                                    delta};
  outward_motions(state, all());
  const SymmetricNode<Space>* const unsolved = inward_inertias(state, all());
  return unsolved == nullptr ? all_solved : singular_at(unsolved->body);
}

template <class Space>
void SymmetricSweep<Space>::solve(const double* forces, double delta, double* result, std::byte* work) const noexcept {
  const typename Space::Twist still = Space::Twist::zero();
  const SymmetricState<Space> state{nullptr, nullptr, forces, result, work, nodes_.data(), &still, delta};
  for (const SymmetricNode<Space>& node : nodes_) {
    auto& w = *at<NodeWork<Space>>(work, node.work);
    w.V = w.A = still;
    auto* stations = at<StationWork<Space>>(work, node.work_stations);
    for (std::size_t k = 0; k < node.own->stations.size(); ++k) stations[k].V = stations[k].A = still;
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    with_flavor_alone(nodes_[i],
                      [&](auto n, auto flavor) { inward_force<Space, n.value, flavor.value>(nodes_[i], state); });
  }
  outward_accelerations(state, all());
}

template <class Space>
void SymmetricSweep<Space>::inverse(const double* positions, const double* speeds, const double* accelerations,
                                    bool inertial, double* efforts, std::byte* work) const noexcept {
  const typename Space::Twist still = Space::Twist::zero();
  const SymmetricState<Space> state{
      positions, speeds, accelerations, efforts, work, nodes_.data(), inertial ? &still : &world_acceleration_};
  for (const SymmetricNode<Space>& node : nodes_) {
    with_flavor(node, [&](auto n, auto flavor) { outward_motion<Space, n.value, flavor.value>(node, state); });
    with_flavor_alone(node,
                      [&](auto n, auto flavor) { given_acceleration<Space, n.value, flavor.value>(node, state); });
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const SymmetricNode<Space>& node = nodes_[i];
    with_flavor_alone(node, [&](auto n, auto flavor) {
      inward_effort<Space, n.value, flavor.value>(node, state, inertial ? 0.0 : 1.0);
    });
  }
}

template class SymmetricSweep<Spatial>;
template class SymmetricSweep<Planar>;

}  // namespace withy::sweep
