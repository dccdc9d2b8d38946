/// \file
/// Integrals over the mass of a flexible body, bilinear in its fields 1, X, Φ_k and linear in Γ_kl: all that ruthless
/// and strict truncation need of the body's inertia, and what Standard Input Data hold.
#pragma once

#include <string>
#include <vector>

#include "sid.hpp"
#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// Rotary inertia counts as mass at the ends of axes that turn with their section. Pairs kl are at element k n + l.
struct MassIntegrals {
  double mass = 0;               ///< ∫ 1 [kg]
  Vector3 x = Vector3::Zero();   ///< ∫ X
  Matrix3 xx = Matrix3::Zero();  ///< ∫ X Xᵀ
  Matrix3X phi;                  ///< column k: ∫ Φ_k
  std::vector<Matrix3> x_phi;    ///< ∫ X Φ_kᵀ
  std::vector<Matrix3> phi_phi;  ///< ∫ Φ_k Φ_lᵀ
  std::vector<Vector3> gamma;    ///< ∫ Γ_kl
  std::vector<Matrix3> x_gamma;  ///< ∫ X Γ_klᵀ

  explicit MassIntegrals(Eigen::Index modes);
  [[nodiscard]] Eigen::Index modes() const { return phi.cols(); }
  [[nodiscard]] std::size_t pair(Eigen::Index k, Eigen::Index l) const {
    return static_cast<std::size_t>(k * modes() + l);
  }
};

/// Of a body made of particles and sections.
MassIntegrals integrals_of(const ModalShape& shape);

/// How well Standard Input Data describe a mass.
struct SidReport {
  /// What the equations of motion need beyond the data's order zero and the data lack: each a sentence.
  std::vector<std::string> missing;
  /// Largest difference of what the data say twice (mdCM and Ct, J and Gr and Oe, Cr and Ge), relative to the largest
  /// element of these.
  double inconsistency = 0;
  /// The same for the modal mass and the other integrals of products of modes that the particles have, and for the
  /// integrals of Γ.
  double defect = 0;
};

/// Of Standard Input Data. What they do not determine (the directions in which ∫ Φ_k·Φ_l moves, where there is no
/// first order of Gr) is chosen such that some mass has all these integrals; ruthless and strict truncation do not
/// depend on the choice.
/// \throws std::domain_error where no mass has these integrals: what() says which of them contradict each other.
MassIntegrals integrals_of(const sid::Data& data, SidReport& report);

/// Particles of equal mass that have these integrals, to rounding: two for each dimension of the fields but the
/// constant one, in pairs about the mean, so that a mirror image of the body has the mirror image of them. Γ is the
/// smallest there is with its integrals: linear over the mass, Γ = a + Bᵀ X. The largest relative difference that is
/// left (Γ may ask for an extent the body does not have) is added to `defect`.
std::vector<Particle> particles_of(const MassIntegrals& integrals, double& defect);

/// The integrals as matrices of Standard Input Data: mass, mdCM to Oe.
void put_integrals(const MassIntegrals& integrals, sid::Data& data);

}  // namespace withy
