/// \file
/// A strain kinematics without second-order rotation of sections, Θ = 0: Γ has what remains of the complete second
/// order,
///   Γ_ij′ = ½ (ψ_i × (ψ_j × e_x) + ψ_j × (ψ_i × e_x)).
/// It is made of the linear fields of any slender body, built in or foreign.
#include <withy/core/plugin/strain_kinematics.hpp>

#include "bodies.hpp"

namespace example {
namespace {

using withy::SectionField;
using withy::Vector3;

class Unturned final : public withy::StrainKinematics {
 public:
  std::string_view name() const override { return "unturned"; }
  withy::StrainOrder order() const override { return withy::StrainOrder::quadratic; }
  Vector3 rotation_slope(const SectionField&, const SectionField&) const override { return Vector3::Zero(); }
  Vector3 displacement_slope(const SectionField& i, const SectionField& j, const Vector3&) const override {
    const Vector3 ex = Vector3::UnitX();
    return 0.5 * (i.rotation.cross(j.rotation.cross(ex)) + j.rotation.cross(i.rotation.cross(ex)));
  }
};

}  // namespace

withy::Plugin<withy::StrainKinematics> unturned() {
  return {.id = "unturned",
          .summary = "Second-order displacements without second-order rotations",
          .parameters = {},
          .make = [](const withy::Value&, const withy::MakeContext&) -> std::unique_ptr<withy::StrainKinematics> {
            return std::make_unique<Unturned>();
          }};
}

}  // namespace example
