/// \file
/// Strains that are linear in the coordinates, displacements and rotations to second order.
#include "kinematics_plugin.hpp"

namespace withy {

Plugin<StrainKinematics> quadratic_kinematics() {
  return kinematics_plugin<CompleteSecondOrder>(
      "quadratic", "Complete second order: foreshortening and the coupling of bending and twist");
}

}  // namespace withy
