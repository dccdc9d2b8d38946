/// \file
/// An observation of a tree: what is asked for is read from one pass outward to a state.
#pragma once

#include "withy/core/kinematics/observed_tree.hpp"
#include "withy/core/kinematics/tree_pass.hpp"

namespace withy::observed {

/// The pass is made when something is asked for that needs it.
template <class Space>
class TreeObservation final : public Observation {
 public:
  explicit TreeObservation(std::shared_ptr<const Tree<Space>> tree);
  void observe(std::span<const double> y) noexcept override;
  [[nodiscard]] Energies energies() const noexcept override;
  [[nodiscard]] WorldPose frame_pose(int body, int frame) const noexcept override;
  [[nodiscard]] WorldVelocity frame_velocity(int body, int frame) const noexcept override;
  [[nodiscard]] double turning(int body) const noexcept override;
  [[nodiscard]] std::array<double, 3> deflection(int body, int frame) const noexcept override;
  [[nodiscard]] bool expands(int body) const noexcept override;

 private:
  [[nodiscard]] const TreePass<Space>& moved() const noexcept;

  std::shared_ptr<const Tree<Space>> tree_;
  mutable TreePass<Space> pass_;
  mutable bool behind_ = true;  ///< the pass is to be made
};

/// What sums over a tree, and its strain energy, tell of its energies and momenta.
template <class Space>
[[nodiscard]] Energies energies_of(const Tree<Space>& tree, const Sums<Space>& sums, double strain) noexcept;

extern template Energies energies_of(const Tree<Planar>& tree, const Sums<Planar>& sums, double strain) noexcept;
extern template Energies energies_of(const Tree<Spatial>& tree, const Sums<Spatial>& sums, double strain) noexcept;

}  // namespace withy::observed
