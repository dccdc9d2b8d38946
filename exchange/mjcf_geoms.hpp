/// \file
/// Masses of MJCF's geoms.
#pragma once

#include <optional>

#include "mjcf_defaults.hpp"

namespace withy::exchange {

/// Mass, centre and inertia about it, in the axes of the body.
struct MassProperties {
  double mass = 0;
  Vector3 center = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();

  void add(const MassProperties& other);
};

/// Of a geom whose attributes are complete: its density, 1000 kg/m³ unless it says otherwise, fills it evenly, or with
/// `shellinertia` covers its surface [kg/m²]. Nothing where it has no mass (a plane, or looks of density 0); meshes are
/// reported, for their mass is not in the file.
std::optional<MassProperties> mass_of_geom(const Element& geom, const MjcfAngles& angles, Diagnostics& diagnostics);

}  // namespace withy::exchange
