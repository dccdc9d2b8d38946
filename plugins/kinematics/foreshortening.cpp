/// \file
/// Axial shortening alone, the choice of Kane's treatment of beams (Kane, Ryan & Banerjee 1987) and of blade codes made
/// after it: Γ_x = −∫(φ_y′ φ_y′ᵀ + φ_z′ φ_z′ᵀ). It stiffens what spins as the complete second order does. It has no
/// coupling of bending and twist: beams do not buckle laterally in it.
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
    return {-(i.rotation.y() * j.rotation.y() + i.rotation.z() * j.rotation.z()), 0, 0};
  }
};

}  // namespace

Plugin<StrainKinematics> foreshortening_kinematics() {
  return kinematics_plugin<Foreshortening>("foreshortening",
                                           "Axial shortening by bending alone, without coupling of bending and twist");
}

}  // namespace withy
