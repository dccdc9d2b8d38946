/// \file
/// What spins on a flexible body, against what bends it.
#pragma once

#include <cstddef>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/simulation/tree_motion.hpp"

namespace withy {

/// Of every flexible body the gyroscopic moment of what it carries: as the section that carries a spin h turns by
/// θ sin ωt, the spin exerts a moment of h ω θ across both, and the stiffness of the body, its frame held, one of θ
/// over C = Ψ K⁻¹ Ψᵀ. Their ratio is ω |h × C|. Bent alike in two directions, a body with a disk at its tip has
/// frequencies that are off by 0.38 to 0.5 of the ratio where this moment is left out, for a disk that is all mass and
/// one that is all moment of inertia. Allocates nothing after construction.
class CarriedSpin {
 public:
  /// The model must outlive the object.
  explicit CarriedSpin(const Model& model);
  /// At the motions of the tree: h is Σ I (ω − ω_b) of the bodies beyond a section, I about their own centres of mass,
  /// ω_b of the frame of the body that bends.
  void update(const std::vector<BodyMotion>& bodies);
  /// The greatest ratio of a body's sections that carry others, 1; 0 where there are none, or its K has no inverse.
  /// \param frequency ω at which the body vibrates [rad/s]
  [[nodiscard]] double ratio(std::size_t body, const std::vector<BodyMotion>& bodies, double frequency) const;

 private:
  struct Section {
    std::size_t carried;  ///< the body there
    Matrix3 compliance;   ///< C [rad/(N m)], axes of the body that bends
  };
  const Model& model_;
  std::vector<Matrix3> own_;                    ///< I of each body, its axes
  std::vector<std::vector<Section>> sections_;  ///< of each body
  std::vector<Matrix3> inertia_;                ///< Σ I of each body and all beyond, world axes
  std::vector<Vector3> momentum_;               ///< Σ I ω of the same
};

}  // namespace withy
