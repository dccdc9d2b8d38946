/// \file
/// The beam as a body, made of what a scene says of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "beam_profile.hpp"
#include "damping.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/mode_family.hpp"

namespace withy {

/// One kind of strain of the beam with its modes.
struct BeamStrain {
  const char* name;   ///< "bending_y", …
  Vector3 direction;  ///< of θ₁ for a unit slope (bending) or unit twist; of γ (elongation)
  BeamData::Strain kind;
  Profile stiffness;  ///< EI, GJ [N m²], EA or kGA [N]; of a twisted beam those of its twist count across
  std::shared_ptr<const ShapeFunctions> functions;
};

/// Sections whose own axes y_s, z_s are turned about x from those of the body: stiffness and inertia are about the
/// sections' axes then.
struct BeamTwist {
  Profile angle;             ///< β [rad], by which y is turned to y_s
  Profile EI_z, EI_y;        ///< for bending with deflection along y_s, z_s [N m²]
  Profile shear_y, shear_z;  ///< kGA along y_s, z_s [N]; zero without shear
};

/// What the beam consists of.
struct BeamMaterial {
  double length;                                      ///< [m]
  Profile mass_per_length;                            ///< [kg/m]
  std::vector<std::pair<Vector3, Profile>> inertias;  ///< of the sections per length, about an axis [kg m]
  BodyDamping damping;
  std::optional<BeamTwist> twist = {};
  std::vector<std::string> remarks = {};
};

/// Of complete second-order kinematics.
std::unique_ptr<Body> make_beam_body(const BeamMaterial& material, std::vector<BeamStrain> strains);

}  // namespace withy
