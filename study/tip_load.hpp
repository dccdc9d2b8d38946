/// \file
/// What hangs on bodies: its mass, and what hangs at the tips of beams, as functions that carry it know it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/value.hpp"

namespace withy::study {

/// The families of functions that know of a load, where a point names them: the beam's own modes with it and a static
/// shape of the tip, and those of the uniform beam alone.
inline constexpr const char* vibration_modes = "vibration-modes";
inline constexpr const char* loaded_modes = "clamped-loaded";

/// Of each body of a model, in its order.
struct BodyMasses {
  std::vector<double> own;      ///< [kg]
  std::vector<double> carried;  ///< of all that hangs on it, without itself [kg]
};
BodyMasses masses_of(const Model& model);

/// The articulated inertia of what hangs at the tip of each body, in the order of the model's: a symmetric map of
/// twists (angular first, [rad/s], [m/s]) of the tip's section, in its axes and about its origin, to momenta [kg m²/s],
/// [kg m/s]. Hinges beyond give way as they are placed at the state, those that motions drive hold; bodies are rigid
/// and undeformed; loads and what closes loops do not matter. Of a body I, seen through its hinge with the subspace H
/// and the reflected inertia n²J:
///   I − I H (Hᵀ I H + n²J)⁻¹ Hᵀ I   (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 7.1)
/// Zero for bodies without a station `tip`, and where nothing hangs there.
/// \param state of the model
std::vector<Matrix6> tip_loads(const Model& model, const State& state);

/// The value of a beam's `family` for one of its strains: one of these two with the load's mass, inertia and offset in
/// the direction of that strain, to six digits. Where the load has none of them `clamped-free`, but `vibration-modes`
/// where the beam varies: a free tip gives way to no force, and static shapes would only be fast. Nothing where the
/// strain is not one of a beam.
/// \param load of the beam, as tip_loads() gives it
/// \param strain "bending_y", "bending_z", "torsion", "extension", "shear_y", "shear_z"
/// \param family vibration_modes or loaded_modes
/// \param varies whether the beam's properties vary along it
std::optional<Value> loaded_family(const Matrix6& load, const std::string& strain, const std::string& family,
                                   bool varies);

}  // namespace withy::study
