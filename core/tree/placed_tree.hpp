/// \file
/// The tree of nodes together with where each body of the model went.
#pragma once

#include <vector>

#include "withy/core/tree/tree.hpp"

namespace withy {

/// Where a body's frame is fixed: to a node's frame, to the section of one of its stations, or to the world.
struct BodyPlace {
  int node = -1;     ///< −1: the world
  int station = -1;  ///< −1: the node's frame
  Pose pose;         ///< of the body's frame there; a flexible body's is always on its node's frame
};

/// For what is told of bodies that have become parts of nodes.
struct PlacedTree : NodeTree {
  std::vector<BodyPlace> places;  ///< one a body of the model
};

/// compile_tree with the places; in three dimensions whatever moves where `planar` is false.
PlacedTree compile_placed_tree(const Model& model, bool planar = true);

}  // namespace withy
