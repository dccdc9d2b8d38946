#include "withy/core/sweep/branches.hpp"

#include <algorithm>
#include <numeric>
#include <queue>

namespace withy::sweep {
namespace {

/// Costs and places of all that hangs on each node.
struct Subtrees {
  std::vector<double> cost;      ///< with the node itself
  std::vector<std::size_t> end;  ///< the node behind the last
  std::vector<std::vector<std::size_t>> children;

  Subtrees(std::span<const int> parents, std::span<const double> costs)
      : cost(costs.begin(), costs.end()), end(parents.size()), children(parents.size()) {
    for (std::size_t i = parents.size(); i-- > 0;) {
      end[i] = std::max(end[i], i + 1);
      if (parents[i] < 0) continue;
      const auto parent = static_cast<std::size_t>(parents[i]);
      cost[parent] += cost[i];
      end[parent] = std::max(end[parent], end[i]);
      children[parent].push_back(i);
    }
  }
};

/// Goes from the world outward: the greatest branch is cut behind its first nodes, which become trunk, as long as that
/// may make the whole quicker. Finds how many cuts are best.
class Cutter {
 public:
  Cutter(std::span<const int> parents, std::span<const double> costs, std::size_t threads)
      : parents_(parents),
        costs_(costs),
        threads_(static_cast<double>(threads)),
        tree_(parents, costs),
        branch_cost_(tree_.cost) {
    for (std::size_t i = 0; i < costs.size(); ++i) branch_cost_[i] -= costs[i];
  }

  /// Nodes of the trunk whose branches are cut further, in the order of the cuts.
  std::vector<std::size_t> best_cuts() {
    begin();
    std::vector<std::size_t> cuts;
    double best = time();
    std::size_t best_count = 0;
    while (!branches_.empty() && branches_.top().first > 0 && trunk_ < best) {
      cuts.push_back(branches_.top().second);
      cut();
      if (time() < best) {
        best = time();
        best_count = cuts.size();
      }
    }
    cuts.resize(best_count);
    return cuts;
  }

  /// The trunk after these cuts: whether a node is in it.
  [[nodiscard]] std::vector<bool> trunk(const std::vector<std::size_t>& cuts) const {
    std::vector<bool> in(parents_.size(), false);
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = parents_[i] < 0;
    for (const std::size_t node : cuts)
      for (const std::size_t child : tree_.children[node]) in[child] = true;
    return in;
  }
  [[nodiscard]] NodeRange branch(std::size_t node) const { return {node + 1, tree_.end[node]}; }
  [[nodiscard]] double branch_cost(std::size_t node) const { return branch_cost_[node]; }
  [[nodiscard]] bool bears(std::size_t node) const { return !tree_.children[node].empty(); }

 private:
  void begin() {
    for (std::size_t i = 0; i < parents_.size(); ++i)
      if (parents_[i] < 0) add(i);
  }
  void add(std::size_t node) {
    trunk_ += costs_[node];
    hanging_ += branch_cost_[node];
    branches_.emplace(branch_cost_[node], node);
  }
  void cut() {
    const std::size_t node = branches_.top().second;
    branches_.pop();
    hanging_ -= branch_cost_[node];
    for (const std::size_t child : tree_.children[node]) add(child);
  }
  /// No thread can have less than its part, nor less than the greatest branch.
  [[nodiscard]] double time() const {
    return trunk_ + std::max(hanging_ / threads_, branches_.empty() ? 0.0 : branches_.top().first);
  }

  std::span<const int> parents_;
  std::span<const double> costs_;
  double threads_;
  Subtrees tree_;
  std::vector<double> branch_cost_;  ///< of what hangs on each node
  std::priority_queue<std::pair<double, std::size_t>> branches_;
  double trunk_ = 0, hanging_ = 0;
};

}  // namespace

std::vector<std::size_t> Branches::groups(std::size_t nodes) const {
  std::vector<std::size_t> groups(nodes, of_thread.size());
  for (std::size_t k = 0; k < of_thread.size(); ++k)
    for (const NodeRange& range : of_thread[k])
      std::fill(groups.begin() + static_cast<std::ptrdiff_t>(range.first),
                groups.begin() + static_cast<std::ptrdiff_t>(range.end), k);
  return groups;
}

Branches cut_tree(std::span<const int> parents, std::span<const double> costs, std::size_t threads) {
  Cutter cutter(parents, costs, threads);
  const std::vector<bool> trunk = cutter.trunk(cutter.best_cuts());
  Branches result;
  result.of_thread.resize(threads);
  double trunk_cost = 0;
  std::vector<std::size_t> bearing;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (!trunk[i]) continue;
    trunk_cost += costs[i];
    if (!result.trunk.empty() && result.trunk.back().end == i) {
      ++result.trunk.back().end;
    } else {
      result.trunk.push_back({i, i + 1});
    }
    // The siblings of a node of the trunk are in it: the first child tells of all.
    if (cutter.bears(i) && !trunk[i + 1]) bearing.push_back(i);
  }
  // The greatest branches first, each to the thread that has least.
  std::stable_sort(bearing.begin(), bearing.end(),
                   [&](std::size_t a, std::size_t b) { return cutter.branch_cost(a) > cutter.branch_cost(b); });
  std::vector<double> load(threads, 0.0);
  for (const std::size_t node : bearing) {
    const auto k = static_cast<std::size_t>(std::min_element(load.begin(), load.end()) - load.begin());
    load[k] += cutter.branch_cost(node);
    result.of_thread[k].push_back(cutter.branch(node));
  }
  for (std::vector<NodeRange>& ranges : result.of_thread)
    std::sort(ranges.begin(), ranges.end(), [](const NodeRange& a, const NodeRange& b) { return a.first < b.first; });
  const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
  result.share = all > 0 ? (trunk_cost + *std::max_element(load.begin(), load.end())) / all : 1;
  return result;
}

}  // namespace withy::sweep
