#include "withy/core/sweep/lanes/lane_sweep.hpp"

#include "withy/core/sweep/lanes/lane_nodes.hpp"
#include "withy/core/sweep/symmetric/symmetric_kernel.hpp"
#include "withy/core/sweep/symmetric/symmetric_layout.hpp"

namespace withy::sweep {
namespace {

/// As with_flavor, with the counts of modes that most beams have: each takes the compiler seconds.
template <class Space, class Action>
inline void in_lanes_with_flavor(const SymmetricNode<Space>& node, Action&& action) {
  switch (node.modes) {
    case 0:
      return action(std::integral_constant<int, 0>{}, std::integral_constant<Flavor, Flavor::rigid>{});
    case 2:
      return with_flavor_of(node, std::integral_constant<int, 2>{}, action);
    case 4:
      return with_flavor_of(node, std::integral_constant<int, 4>{}, action);
    default:
      return with_flavor_of(node, std::integral_constant<int, -1>{}, action);
  }
}

}  // namespace

template <class Space>
std::string LaneSweep<Space>::refusal(const SymmetricSweep<Space>& sweep) {
  for (const SymmetricNode<Space>& node : sweep.nodes()) {
    if (node.flavor == Flavor::exact) return "a beam moves by exact kinematics";
    if (!single(node.joint.kind) && node.joint.kind != Joint::fixed) return "a hinge has several rates";
    if (!has_sections<Many> && node.own->rotary.packs > 0) return "sections of a beam in space have rotary inertia";
  }
  return {};
}

template <class Space>
LaneSweep<Space>::LaneSweep(const SymmetricSweep<Space>& sweep) : nodes_(sweep.nodes().size()) {
  for (std::size_t lane = 0; lane < cases_at_once; ++lane) put(lane, sweep);
  work_size_ = lay_out(nodes_);
  for (const SymmetricNode<Many>& node : nodes_) driven_ = driven_ || node.joint.driven;
}

template <class Space>
bool LaneSweep<Space>::fits(const SymmetricSweep<Space>& sweep) const {
  return std::equal(nodes_.begin(), nodes_.end(), sweep.nodes().begin(), sweep.nodes().end(),
                    [](const auto& a, const auto& b) { return alike(a, b); });
}

template <class Space>
void LaneSweep<Space>::put(std::size_t lane, const SymmetricSweep<Space>& sweep) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) sweep::put(lane, sweep.nodes()[i], nodes_[i]);
  sweep::put(lane, sweep.world_acceleration(), world_acceleration_);
}

template <class Space>
LaneSet LaneSweep<Space>::accelerations(const Lanes* positions, const Lanes* speeds, Lanes* efforts, Lanes* result,
                                        std::byte* work, Evaluation* failures) const noexcept {
  const SymmetricState<Many> state{positions, speeds, efforts, result, work, nodes_.data(), &world_acceleration_,
                                   0,         efforts};
  LaneSet solved = LaneSet::all();
  for (const SymmetricNode<Many>& node : nodes_) {
    in_lanes_with_flavor(node, [&](auto n, auto flavor) { outward_motion<Many, n.value, flavor.value>(node, state); });
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const SymmetricNode<Many>& node = nodes_[i];
    LaneSet good;
    in_lanes_with_flavor(node,
                         [&](auto n, auto flavor) { good = inward_inertia<Many, n.value, flavor.value>(node, state); });
    if (good.bits == LaneSet::all().bits) continue;
    for (std::size_t lane = 0; lane < cases_at_once; ++lane)
      if (!good.has(lane) && solved.has(lane)) failures[lane] = {Evaluation::Outcome::singular, node.body};
    solved = solved & good;
    if (none(good)) return solved;
  }
  for (const SymmetricNode<Many>& node : nodes_) {
    in_lanes_with_flavor(node,
                         [&](auto n, auto flavor) { outward_acceleration<Many, n.value, flavor.value>(node, state); });
  }
  return solved;
}

template class LaneSweep<Planar>;
template class LaneSweep<Spatial>;

}  // namespace withy::sweep
