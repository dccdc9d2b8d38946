/// \file
/// The symmetric sweep over several cases at once: the kernels of symmetric_kernel.hpp with Lanes for numbers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "withy/core/spatial/lanes.hpp"
#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy::sweep {

/// The space of several cases of a space.
template <class Space>
struct LanesOf;
template <>
struct LanesOf<Planar> {
  using Type = PlanarOf<Lanes>;
};
template <>
struct LanesOf<Spatial> {
  using Type = SpatialOf<Lanes>;
};

/// As many trees as a register has numbers, that differ in numbers only. The constants of a lane are those of the sweep
/// put there; a lane that is not in use computes with what it last had, and nobody looks.
template <class Space>
class LaneSweep {
 public:
  /// Why a sweep cannot take part; empty where it can.
  static std::string refusal(const SymmetricSweep<Space>& sweep);
  /// All lanes begin with `sweep`, which has no refusal.
  explicit LaneSweep(const SymmetricSweep<Space>& sweep);
  /// Whether a sweep, without a refusal of its own, differs from these in numbers only.
  [[nodiscard]] bool fits(const SymmetricSweep<Space>& sweep) const;
  /// Puts one that fits into a lane.
  void put(std::size_t lane, const SymmetricSweep<Space>& sweep);

  [[nodiscard]] std::size_t work_size() const { return work_size_; }
  /// Whether there are driven hinges: accelerations given in `result`, and efforts left on them.
  [[nodiscard]] bool driven() const { return driven_; }
  /// SymmetricSweep::accelerations of each lane, with M itself. \param failures one a lane: set where it has none
  /// \returns the lanes that have them
  LaneSet accelerations(const Lanes* positions, const Lanes* speeds, Lanes* efforts, Lanes* result, std::byte* work,
                        Evaluation* failures) const noexcept;

 private:
  using Many = typename LanesOf<Space>::Type;

  std::vector<SymmetricNode<Many>> nodes_;
  typename Many::Twist world_acceleration_;
  std::size_t work_size_ = 0;
  bool driven_ = false;
};

extern template class LaneSweep<Planar>;
extern template class LaneSweep<Spatial>;

}  // namespace withy::sweep
