/// \file
/// A tree cut into a trunk and branches that threads sweep at the same time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace withy::sweep {

/// Nodes first ≤ i < end.
struct NodeRange {
  std::size_t first = 0, end = 0;
};

/// A cut through a tree whose nodes stand depth first, so that all that hangs on a node stands behind it. A branch is
/// all that hangs on one node of the trunk: what is summed on that node is then summed by one thread, in the order of
/// one sweep over all nodes, and to the same bits. The siblings of a node of the trunk are in the trunk.
struct Branches {
  std::vector<NodeRange> trunk;                   ///< increasing
  std::vector<std::vector<NodeRange>> of_thread;  ///< branches of each thread, increasing
  double share = 1;  ///< cost on the way through the trunk and the thread with most, of the cost of all nodes

  /// For each node the number of its thread; that of the trunk is the count of threads.
  [[nodiscard]] std::vector<std::size_t> groups(std::size_t nodes) const;
};

/// The cut with the least `share`. (Tests see it.) \param parents of each node; −1: the world \param costs of each
/// node, in any unit \param threads at least 1
[[gnu::visibility("default")]] Branches cut_tree(std::span<const int> parents, std::span<const double> costs,
                                                 std::size_t threads);

}  // namespace withy::sweep
