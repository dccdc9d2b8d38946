/// \file
/// Nodes of a symmetric sweep in the work memory, and the kernels that belong to each.
#pragma once

#include <algorithm>
#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "withy/core/sweep/symmetric/symmetric_terms.hpp"
#include "withy/core/sweep/with_modes.hpp"

namespace withy::sweep {

/// Calls action(n, flavor), both std::integral_constant, for a node of n modes; see with_modes.
template <class Space, class Modes, class Action>
inline void with_flavor_of(const SymmetricNode<Space>& node, Modes n, Action&& action) {
  if (node.flavor == Flavor::frozen) {
    action(n, std::integral_constant<Flavor, Flavor::frozen>{});
    return;
  }
  if constexpr (has_rods<Space>) {
    if (node.flavor == Flavor::exact) return action(n, std::integral_constant<Flavor, Flavor::exact>{});
  }
  action(n, std::integral_constant<Flavor, Flavor::full>{});
}

/// For the passes of an evaluation: few modes are a number that the compiler knows.
template <class Space, class Action>
inline void with_flavor(const SymmetricNode<Space>& node, Action&& action) {
  with_modes(node.modes, [&](auto n) {
    if constexpr (n.value == 0) {
      action(n, std::integral_constant<Flavor, Flavor::rigid>{});
    } else {
      with_flavor_of(node, n, action);
    }
  });
}

/// For the other passes: any number of modes in one instance.
template <class Space, class Action>
inline void with_flavor_alone(const SymmetricNode<Space>& node, Action&& action) {
  if (node.modes == 0) {
    action(std::integral_constant<int, 0>{}, std::integral_constant<Flavor, Flavor::rigid>{});
  } else {
    with_flavor_of(node, std::integral_constant<int, -1>{}, action);
  }
}

/// Gives each sum of articulated inertias its place: one for each that is alive at a time on the way inward, so that a
/// chain needs one, which stays in the nearest cache. Of a group of nodes that a thread has for itself, which goes
/// before the last group, the trunk, the places are its own.
template <class Space>
void place_sums(std::vector<SymmetricNode<Space>>& nodes, std::span<const std::size_t> groups, WorkLayout& memory) {
  const std::size_t trunk = groups.empty() ? 0 : *std::max_element(groups.begin(), groups.end());
  const auto group = [&](std::size_t i) { return groups.empty() ? 0 : groups[i]; };
  std::vector<std::vector<std::size_t>> vacancies(trunk + 1);
  std::map<std::pair<int, int>, std::size_t> sums;  // of node and station
  const auto place = [&](std::size_t i) {
    SymmetricNode<Space>& node = nodes[i];
    std::vector<std::size_t>& vacant = vacancies[group(i)];
    // Its own have been read when it writes to the next.
    for (int k = -1; k < static_cast<int>(node.own->stations.size()); ++k) {
      const auto own = sums.find({static_cast<int>(i), k});
      if (own == sums.end()) continue;
      if (k < 0) {
        node.work_I = own->second;
      } else if (const auto station = static_cast<std::size_t>(k); node.own->stations[station].work_I != own->second) {
        node.own.edit([&](SymmetricBody<Space>& body) { body.stations[station].work_I = own->second; });
      }
      vacant.push_back(own->second);
      sums.erase(own);
    }
    if (node.parent < 0) return;
    const auto [outer, first] = sums.try_emplace({node.parent, node.parent_station});
    if (first) {
      if (vacant.empty()) vacant.push_back(memory.template take<typename Space::Inertia>(1));
      outer->second = vacant.back();
      vacant.pop_back();
    }
    node.begins = first;
    node.begins_frozen =
        first && node.parent_station >= 0 && nodes[static_cast<std::size_t>(node.parent)].flavor == Flavor::frozen;
    node.work_outer_I = outer->second;
  };
  for (const bool of_trunk : {false, true})
    for (std::size_t i = nodes.size(); i-- > 0;)
      if ((group(i) == trunk) == of_trunk) place(i);
}

/// Lays out the work memory of all nodes. \returns its size in bytes \param groups as Branches::groups, where threads
/// sweep branches; else empty
template <class Space>
std::size_t lay_out(std::vector<SymmetricNode<Space>>& nodes, std::span<const std::size_t> groups = {}) {
  using Scalar = typename Space::Scalar;
  WorkLayout memory;
  place_sums(nodes, groups, memory);
  // What no pass leaves for another is shared by all nodes of a thread.
  std::size_t most = 0, most_P = 0, most_rod = 0;
  for (const SymmetricNode<Space>& node : nodes) {
    const auto modes = static_cast<std::size_t>(node.modes);
    most = std::max(most, modes);
    most_P = std::max(most_P, mass_scratch(node.own->mass, modes));
    if constexpr (has_sections<Space>) most_P = std::max(most_P, section_scratch(node.own->rotary, modes));
    if constexpr (has_rods<Space>) {
      if (node.own->rod.empty()) continue;
      most_rod = std::max(most_rod, rod_work(*node.own->rod, node.modes));
      most_P = std::max(most_P, rod_scratch(*node.own->rod, node.modes));
    }
  }
  std::vector<std::size_t> shared_h, shared_P, shared_rod;
  const std::size_t count = groups.empty() ? 1 : *std::max_element(groups.begin(), groups.end()) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    shared_h.push_back(memory.template take<Scalar>(most));
    shared_P.push_back(memory.template take<typename Space::Group>(most_P));
    shared_rod.push_back(memory.template take<Pack>(most_rod));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    SymmetricNode<Space>& node = nodes[i];
    const std::size_t group = groups.empty() ? 0 : groups[i];
    using Twist = typename Space::Twist;
    const auto n = static_cast<std::size_t>(node.modes);
    node.work = memory.template take<NodeWork<Space>>(1);
    node.work_stations = memory.template take<StationWork<Space>>(node.own->stations.size());
    if (node.flavor != Flavor::frozen) {
      node.work_frames = memory.template take<typename Space::Frame>(node.own->stations.size());
      node.work_J = memory.template take<Twist>(n * (node.own->stations.size() + (node.root_station >= 0 ? 1 : 0)));
    }
    node.work_C = memory.template take<Twist>(n);
    node.work_G = memory.template take<Scalar>(n * n);
    node.work_y = memory.template take<Scalar>(n);
    if (!node.own->rod.empty()) node.work_rod_mass = memory.template take<RodMass<Space>>(1);
    node.work_h = shared_h[group];
    node.work_P = shared_P[group];
    node.work_rod = shared_rod[group];
    if (node.joint.driven) node.work_driven = memory.template take<DrivenWork<Space>>(1);
    if (node.root_station >= 0) node.work_root = memory.template take<RootWork<Space>>(1);
    if (!single(node.joint.kind) && node.joint.kind != Joint::fixed)
      node.work_elimination = memory.template take<JointElimination<Space>>(1);
  }
  return memory.size();
}

}  // namespace withy::sweep
