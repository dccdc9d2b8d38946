/// \file
/// What bends in a plane, the choice of Kane's treatment of beams (Kane, Ryan & Banerjee 1987) and of blade codes made
/// after it: the complete second order without twist, ψ_x = 0 and Θ = 0. Of beams that only bend that is the axial
/// shortening alone, Γ_x = −∫(φ_y′ φ_y′ᵀ + φ_z′ φ_z′ᵀ). It stiffens what spins as the complete second order does. It
/// has no coupling of bending and twist: beams do not buckle laterally in it.
#include "kinematics_plugin.hpp"

namespace withy {
namespace {

class Foreshortening final : public StrainKinematics {
 public:
  std::string_view name() const override { return "foreshortening"; }
  StrainOrder order() const override { return StrainOrder::quadratic; }
  Vector3 rotation_slope(const SectionField& /*i*/, const SectionField& /*j*/) const override {
    return Vector3::Zero();
  }
  Vector3 displacement_slope(const SectionField& i, const SectionField& j, const Vector3& /*theta*/) const override {
    const Vector3 a = bending(i), b = bending(j);
    // Sections take their shear and extension with them as they turn: a column with shear falls earlier by it.
    return Vector3(-a.dot(b), 0, 0) + a.cross(j.elongation) + b.cross(i.elongation);
  }

 private:
  static Vector3 bending(const SectionField& f) { return {0, f.rotation.y(), f.rotation.z()}; }
};

}  // namespace

Plugin<StrainKinematics> foreshortening_kinematics() {
  return kinematics_plugin<Foreshortening>(
      "foreshortening", "Second order of what bends, shears and stretches, without coupling of bending and twist");
}

}  // namespace withy
