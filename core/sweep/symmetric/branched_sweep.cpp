#include "withy/core/sweep/symmetric/branched_sweep.hpp"

#include <atomic>
#include <span>

#include "withy/core/sweep/symmetric/shared_bodies.hpp"
#include "withy/core/sweep/symmetric/symmetric_layout.hpp"

namespace withy::sweep {
namespace {

/// What a node costs, in rigid ones: measured, for the balance of threads alone.
template <class Space>
double cost_of(const SymmetricNode<Space>& node) {
  const double n = node.modes;
  if (node.flavor == Flavor::frozen) return 1 + 0.35 * n;
  return 1 + 0.6 * n + 0.1 * n * n;
}

template <class Space>
Branches branches_of(const std::vector<SymmetricNode<Space>>& nodes, std::size_t threads) {
  std::vector<int> parents;
  std::vector<double> costs;
  for (const SymmetricNode<Space>& node : nodes) {
    parents.push_back(node.parent);
    costs.push_back(cost_of(node));
  }
  return cut_tree(parents, costs, threads);
}

}  // namespace

template <class Space>
BranchedSweep<Space>::BranchedSweep(const SymmetricSweep<Space>& sweep, std::size_t threads)
    : nodes_(sweep.nodes()),
      world_acceleration_(sweep.world_acceleration()),
      branches_(branches_of(nodes_, threads)),
      work_size_(lay_out(nodes_, branches_.groups(nodes_.size()))) {
  share_bodies(nodes_);
}

template <class Space>
Evaluation BranchedSweep<Space>::accelerations(const double* positions, const double* speeds, double* efforts,
                                               double* result, std::byte* work, ThreadTeam& team) const noexcept {
  const SymmetricState<Space> state{positions, speeds, efforts, result, work, nodes_.data(), &world_acceleration_,
                                    0,         efforts};
  if (team.take()) {
    const Evaluation evaluation = sweep_branches(state, team);
    team.give_back();
    if (evaluation.ok()) return evaluation;
  }
  // The team is busy; or it says of a bad end which node one sweep over all meets first.
  return SymmetricSweep<Space>::accelerations(state, {0, nodes_.size()});
}

template <class Space>
Evaluation BranchedSweep<Space>::sweep_branches(const SymmetricState<Space>& state, ThreadTeam& team) const noexcept {
  using Sweep = SymmetricSweep<Space>;
  for (const NodeRange& range : branches_.trunk) Sweep::outward_motions(state, range);
  std::atomic<bool> good = true;
  const auto own = [this](std::size_t member) -> std::span<const NodeRange> {
    if (member < branches_.of_thread.size()) return branches_.of_thread[member];
    return {};
  };
  team.run([&](std::size_t member) {
    const std::span<const NodeRange> ranges = own(member);
    for (const NodeRange& range : ranges) Sweep::outward_motions(state, range);
    for (std::size_t i = ranges.size(); i-- > 0;)
      if (Sweep::inward_inertias(state, ranges[i]) != nullptr) good = false;
  });
  if (!good) return {Evaluation::Outcome::singular};
  for (std::size_t i = branches_.trunk.size(); i-- > 0;)
    if (const auto* const unsolved = Sweep::inward_inertias(state, branches_.trunk[i]))
      return singular_at(unsolved->body);
  for (const NodeRange& range : branches_.trunk) Sweep::outward_accelerations(state, range);
  team.run([&](std::size_t member) {
    for (const NodeRange& range : own(member)) Sweep::outward_accelerations(state, range);
  });
  return {};
}

template class BranchedSweep<Planar>;
template class BranchedSweep<Spatial>;

}  // namespace withy::sweep
