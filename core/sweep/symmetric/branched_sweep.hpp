/// \file
/// The symmetric sweep over one tree with its branches on threads.
#pragma once

#include <string>
#include <vector>

#include "withy/core/sweep/branches.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"
#include "withy/core/sweep/thread_team.hpp"

namespace withy::sweep {

/// A sweep whose branches are swept at the same time: the trunk outward; each branch outward and inward on its thread;
/// the trunk inward and outward; each branch outward. Nodes are evaluated by the code of SymmetricSweep, and sums are
/// taken in its order, so that all results are the same to the last bit, however many threads there are.
template <class Space>
class BranchedSweep {
 public:
  BranchedSweep(const SymmetricSweep<Space>& sweep, std::size_t threads);
  /// Bytes of work memory.
  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  [[nodiscard]] const Branches& branches() const { return branches_; }
  /// As SymmetricSweep::accelerations with delta 0. The team has at least as many members as there are threads, or
  /// is another caller's: then this thread sweeps all.
  Evaluation accelerations(const double* positions, const double* speeds, double* efforts, double* result,
                           std::byte* work, ThreadTeam& team) const noexcept;

 private:
  Evaluation sweep_branches(const SymmetricState<Space>& state, ThreadTeam& team) const noexcept;

  std::vector<SymmetricNode<Space>> nodes_;  ///< with a layout of their work in which threads share nothing
  typename Space::Twist world_acceleration_;
  Branches branches_;
  std::size_t work_size_ = 0;
};

extern template class BranchedSweep<Spatial>;
extern template class BranchedSweep<Planar>;

}  // namespace withy::sweep
