/// \file
/// Solid elements of CalculiX and Abaqus: shape functions and the rules by which CalculiX integrates them.
/// Numbering of nodes as in the Abaqus and CalculiX manuals; G. Dhondt, "The Finite Element Method for
/// Three-Dimensional Thermomechanical Applications", Wiley 2004, section 2.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy::fem {

struct ElementShape {
  int nodes = 0;
  std::vector<double> weights;      ///< of the integration points, in the element's own coordinates
  std::vector<Matrix3X> gradients;  ///< of the shape functions by these coordinates there, 3×nodes
};

/// C3D4, C3D6, C3D8, C3D10, C3D15, C3D20 or C3D20R; null for others.
const ElementShape* element_shape(const std::string& type);

}  // namespace withy::fem
