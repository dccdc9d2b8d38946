#include "withy/core/kinematics/lane_energies.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "withy/core/kinematics/tree_observation.hpp"
#include "withy/core/kinematics/tree_pass.hpp"
#include "withy/core/spatial/lane_transfer.hpp"
#include "withy/core/sweep/lanes/lane_nodes.hpp"
#include "withy/core/sweep/lanes/lane_sweep.hpp"

namespace withy {
namespace observed {
namespace {

using sweep::put;

void put(std::size_t lane, const Height<double>& from, Height<Lanes>& to) {
  to.frame.set(lane, from.frame), to.moment.set(lane, from.moment);
  to.xz.set(lane, from.xz), to.yz.set(lane, from.yz);
}

template <class Space, class Many>
void put(std::size_t lane, const Fixed<Space>& from, Fixed<Many>& to) {
  to.empty = from.empty;
  put(lane, from.part, to.part);
  put(lane, from.height, to.height);
}

template <class Space, class Many>
void put(std::size_t lane, const Station<Space>& from, Station<Many>& to) {
  to.needed = from.needed;
  put(lane, from.fields.X, to.fields.X);
  put(lane, from.fields.first, to.fields.first);
  put(lane, from.fields.second, to.fields.second);
  put(lane, from.carried, to.carried);
}

template <class Space, class Many>
void put(std::size_t lane, const Node<Space>& from, Node<Many>& to) {
  to.parent = from.parent, to.parent_station = from.parent_station, to.root_station = from.root_station;
  to.modes = from.modes, to.mode_position = from.mode_position, to.mode_speed = from.mode_speed;
  to.first_station = from.first_station;
  put(lane, from.joint, to.joint);
  put(lane, from.M, to.M);
  put(lane, from.base, to.base);
  put(lane, from.stiffness, to.stiffness);
  put(lane, from.mass, to.mass);
  if constexpr (sweep::has_sections<Many>) put(lane, from.rotary, to.rotary);
  to.flexible_height.set(lane, from.flexible_height);
  to.stations.resize(from.stations.size());
  for (std::size_t k = 0; k < from.stations.size(); ++k) put(lane, from.stations[k], to.stations[k]);
}

/// All of a node that its numbers do not tell.
template <class Space>
auto structure(const Node<Space>& n) {
  const sweep::JointData<Space>& j = n.joint;
  return std::tuple(n.parent, n.parent_station, n.root_station, n.modes, n.mode_position, n.mode_speed, n.first_station,
                    j.kind, j.direction, j.position, j.speed, n.base.empty, n.mass.straight, n.mass.rank,
                    n.mass.second_order, n.rotary.sections, n.stations.size());
}
template <class Space>
auto structure(const Station<Space>& s) {
  return std::tuple(s.needed, s.carried.empty, s.fields.first.size(), s.fields.second.size());
}

template <class Space, class Many>
bool alike(const Node<Space>& a, const Node<Many>& b) {
  return structure(a) == structure(b) && a.mass.runs == b.mass.runs && a.rotary.runs == b.rotary.runs &&
         std::equal(a.stations.begin(), a.stations.end(), b.stations.begin(),
                    [](const auto& s, const auto& t) { return structure(s) == structure(t); });
}

template <class Space>
bool has_lanes(const Tree<Space>& tree) {
  using Many = typename sweep::LanesOf<Space>::Type;
  return std::none_of(tree.nodes.begin(), tree.nodes.end(), [](const Node<Space>& n) {
    return n.is_rod() || (!sweep::single(n.joint.kind) && n.joint.kind != sweep::Joint::fixed) ||
           (!sweep::has_sections<Many> && n.rotary.packs > 0);
  });
}

void extract(std::size_t lane, const PlanarOf<Lanes>::Position& from, Planar::Position& to) {
  to = {from.x[lane], from.y[lane]};
}
void extract(std::size_t lane, const PlanarOf<Lanes>::Twist& from, Planar::Twist& to) {
  to = {from.w[lane], from.x[lane], from.y[lane]};
}
void extract(std::size_t lane, const LaneTriple& from, Triple& to) {
  to = Triple(from[0][lane], from[1][lane], from[2][lane]);
}
void extract(std::size_t lane, const SpatialOf<Lanes>::Twist& from, Spatial::Twist& to) {
  extract(lane, from.w, to.w), extract(lane, from.v, to.v);
}

template <class Space>
class EnergiesOfTrees final : public LaneEnergies {
 public:
  explicit EnergiesOfTrees(const Tree<Space>& first)
      : nodes_(filled(first)), pass_(nodes_, first.size, first.positions), idle_(first.size, 0.0) {
    trees_.fill(&first);
  }

  [[nodiscard]] bool fits(const ObservedModel& model) const override {
    const auto* tree = dynamic_cast<const Tree<Space>*>(&model);
    return tree != nullptr && has_lanes(*tree) && tree->size == idle_.size() &&
           std::equal(tree->nodes.begin(), tree->nodes.end(), nodes_.begin(), nodes_.end(),
                      [](const auto& a, const auto& b) { return alike(a, b); });
  }

  void put(std::size_t lane, const ObservedModel& model) override {
    trees_[lane] = &dynamic_cast<const Tree<Space>&>(model);
    for (std::size_t i = 0; i < nodes_.size(); ++i) observed::put(lane, trees_[lane]->nodes[i], nodes_[i]);
  }

  void find(std::span<LaneEnergy* const> calls) noexcept override {
    std::array<const double*, cases_at_once> y;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      y[lane] = calls[lane] != nullptr ? calls[lane]->y.data() : idle_.data();
    gather(y, idle_.size(), pass_.y().data());
    find_here([&](std::size_t lane) { return calls[lane] != nullptr ? &calls[lane]->energies : nullptr; });
  }

  void find(const Lanes* y, std::span<Energies* const> energies) noexcept override {
    std::copy_n(y, idle_.size(), pass_.y().data());
    find_here([&](std::size_t lane) { return energies[lane]; });
  }

 private:
  using Many = typename sweep::LanesOf<Space>::Type;

  /// At the pass's states. \param place of a lane's energies; null: nobody asks for them
  template <class PlaceOf>
  void find_here(const PlaceOf& place) noexcept {
    pass_.move();
    const Sums<Many> all = pass_.sums();
    const Lanes strain = pass_.strain_energy();
    // All of them before the first is read: a load of several numbers waits for those that were stored one by one.
    std::array<Sums<Space>, cases_at_once> own;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
      own[lane].kinetic = all.kinetic[lane];
      extract(lane, all.momentum, own[lane].momentum);
      extract(lane, all.moment, own[lane].moment);
      extract(lane, all.across, own[lane].across);
    }
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (Energies* const to = place(lane)) *to = energies_of(*trees_[lane], own[lane], strain[lane]);
  }

  static std::vector<Node<Many>> filled(const Tree<Space>& tree) {
    std::vector<Node<Many>> nodes(tree.nodes.size());
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      for (std::size_t i = 0; i < nodes.size(); ++i) observed::put(lane, tree.nodes[i], nodes[i]);
    return nodes;
  }

  std::vector<Node<Many>> nodes_;
  TreePass<Many> pass_;
  std::vector<double> idle_;  ///< the state of lanes without a call
  std::array<const Tree<Space>*, cases_at_once> trees_{};
};

}  // namespace
}  // namespace observed

std::unique_ptr<LaneEnergies> lane_energies(const ObservedModel& model) {
  using observed::Tree, observed::EnergiesOfTrees;
  if (const auto* planar = dynamic_cast<const Tree<Planar>*>(&model))
    return observed::has_lanes(*planar) ? std::make_unique<EnergiesOfTrees<Planar>>(*planar) : nullptr;
  if (const auto* spatial = dynamic_cast<const Tree<Spatial>*>(&model))
    return observed::has_lanes(*spatial) ? std::make_unique<EnergiesOfTrees<Spatial>>(*spatial) : nullptr;
  return nullptr;
}

}  // namespace withy
