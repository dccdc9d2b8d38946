/// \file
/// Faces of elements of CalculiX and Abaqus: solids, shells, membranes and surfaces. Numbering of nodes as in the
/// manuals of the two, see element_shape.hpp.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace withy::fem {

/// Nodes of an element around a face, places in its list of nodes.
struct ElementFace {
  std::vector<std::size_t> corners;  ///< three or four; of a solid counter-clockwise from outside
  std::vector<std::size_t> middles;  ///< of the edges, the first between the first two corners; empty where it has none
  std::optional<std::size_t> centre;
};

struct ElementFaces {
  std::size_t nodes = 0;
  bool solid =
      false;  ///< faces enclose it, and two elements share one; else it is one face, which is seen from both sides
  std::vector<ElementFace> faces;
};

/// Of a type in capitals: C3D4 to C3D20 of any formulation, continuum shells SC6 and SC8; shells S3 to S9, STRI3 and
/// STRI65; membranes M3D, surfaces SFM3D and rigid elements R3D of 3 to 9 nodes. Null for others.
const ElementFaces* element_faces(const std::string& type);

}  // namespace withy::fem
