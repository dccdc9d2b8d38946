/// \file
/// The interface of strain kinematics: which relations between displacements and strains hold.
#pragma once

#include <string>
#include <string_view>

#include "withy/core/plugin/terms.hpp"
#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Linear fields of one modal coordinate at a section of a slender body along x, body axes, per unit of the coordinate.
struct SectionField {
  Vector3 rotation;    ///< ψ [rad]
  Vector3 curvature;   ///< κ = ψ′ [1/m]: twist rate, then the two curvatures
  Vector3 elongation;  ///< γ: extension, then the two shears; zero where the body has none
};

/// A strain kinematics. Of the second order it makes maps Γ, Θ (theory, section 1) from a body's linear fields: the
/// body integrates, with Θ = Γ = 0 at its root,
///   Θ_ij′ = rotation_slope(i, j),   Γ_ij′ = displacement_slope(i, j, Θ_ij)
/// and offers the result by Body::expanded. Both are symmetric in i and j. Immutable; threads share it.
class StrainKinematics {
 public:
  virtual ~StrainKinematics() = default;
  /// Its plugin's id, for messages and comparisons.
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// `linear`: it has no second order and is not asked for slopes. `exact`: it does not expand, and its second order is
  /// the complete one.
  [[nodiscard]] virtual StrainOrder order() const = 0;
  /// Whether its second order is the complete one, which every body has of its own: no body is expanded anew then.
  [[nodiscard]] virtual bool complete() const { return false; }
  /// Θ_ij′ [1/m]; here, and below, the complete second order of R′ = R κ̂, r′ = R (e_x + γ).
  [[nodiscard]] virtual Vector3 rotation_slope(const SectionField& i, const SectionField& j) const {
    return 0.5 * (i.rotation.cross(j.curvature) + j.rotation.cross(i.curvature));
  }
  /// Γ_ij′, `theta` being Θ_ij at the section.
  [[nodiscard]] virtual Vector3 displacement_slope(const SectionField& i, const SectionField& j,
                                                   const Vector3& theta) const {
    const Vector3 ex = Vector3::UnitX();
    return theta.cross(ex) + 0.5 * (i.rotation.cross(j.rotation.cross(ex)) + j.rotation.cross(i.rotation.cross(ex))) +
           i.rotation.cross(j.elongation) + j.rotation.cross(i.elongation);
  }
};

/// The complete second order: what bodies have of their own.
class CompleteSecondOrder : public StrainKinematics {
 public:
  [[nodiscard]] std::string_view name() const override { return "quadratic"; }
  [[nodiscard]] StrainOrder order() const override { return StrainOrder::quadratic; }
  [[nodiscard]] bool complete() const override { return true; }
};

/// What is wrong with a strain kinematics, or empty: no name, or of second order slopes that are not finite or not
/// symmetric in their two fields, found of three pairs of these. Whatever it throws comes out.
std::string find_fault(const StrainKinematics& kinematics);

}  // namespace withy
