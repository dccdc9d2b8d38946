/// \file
/// What the sweeps of first order, strict and symmetric truncation, keep of each node alike.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

/// A node at q = 0 with its first derivatives; see Invariants.
template <class Space>
struct FirstOrderConstants {
  using Twist = typename Space::Twist;
  int body = 0, parent = -1, parent_station = -1, modes = 0;
  JointData<Space> joint;
  bool frozen = false;  ///< ruthless: order zero alone
  std::size_t mode_position = 0, mode_speed = 0;
  std::vector<double> stiffness, damping;
  RigidPart<Space> I0;
  std::vector<Variation<Space>> I1;
  std::vector<Twist> C0;
  std::vector<Twist> C1;  ///< ∂C_i/∂q_k, element k n + i
  std::vector<double> G0;

  FirstOrderConstants(const NodeSpec& given, Terms terms, const Invariants& invariants)
      : body(given.body),
        parent(given.parent),
        parent_station(given.parent_station),
        modes(static_cast<int>(given.modes)),
        joint(given),
        frozen(terms.truncation == Truncation::ruthless),
        mode_position(given.mode_position),
        mode_speed(given.mode_speed),
        I0(invariants.I0) {
    for (const RigidInertia& I : invariants.I1) I1.push_back(Variation<Space>::of(I));
    for (int i = 0; i < modes; ++i) {
      C0.push_back(Twist::of(invariants.C0.col(i)));
      for (int j = 0; j < modes; ++j) {
        C1.push_back(Twist::of(invariants.C1[static_cast<std::size_t>(i)].col(j)));
        G0.push_back(invariants.G0(i, j));
        stiffness.push_back(given.stiffness(i, j));
        damping.push_back(given.damping(i, j));
      }
    }
  }
};

/// Turns the joint of a node as rooting turned the section of its parent that it sits on.
template <class Space>
void turn_with_root(const NodeSpec& parent, const NodeSpec& spec, JointData<Space>& joint) {
  if (parent.root_station >= 0) joint.F = Space::make(Pose{parent.M.R.transpose(), Vector3::Zero()} * spec.F);
}

/// What was computed once for all evaluations, a line each.
inline std::vector<std::string> savings_of_first_order(const NodeTree& tree) {
  std::vector<std::string> lines;
  for (const NodeSpec& node : tree.nodes) {
    if (node.modes > 0)
      lines.push_back("'" + node.name + "': mass integrals and their first derivatives, computed once");
  }
  return lines;
}

}  // namespace withy::sweep
