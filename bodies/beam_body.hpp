/// \file
/// The beam as a body, made of what a scene says of it.
#pragma once

#include <memory>
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
  Profile stiffness;  ///< EI, GJ [N m²], EA or kGA [N]
  std::shared_ptr<const ShapeFunctions> functions;
};

/// What the beam consists of.
struct BeamMaterial {
  double length;                                      ///< [m]
  Profile mass_per_length;                            ///< [kg/m]
  std::vector<std::pair<Vector3, Profile>> inertias;  ///< of the sections per length, about an axis [kg m]
  BodyDamping damping;
  std::vector<std::string> remarks = {};
};

/// Of complete second-order kinematics.
std::unique_ptr<Body> make_beam_body(const BeamMaterial& material, std::vector<BeamStrain> strains);

}  // namespace withy
