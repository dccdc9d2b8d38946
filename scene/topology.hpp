/// \file
/// Whether the hinges of a scene make a tree of its bodies.
#pragma once

#include <string>
#include <vector>

#include "withy/scene/check.hpp"

namespace withy {

/// The two ends of a hinge as the scene names them: indices of bodies; −1: world, −2: wrong, reported already.
struct Link {
  std::string name;
  int parent = -2;
  int child = -2;
  Place child_place;
};

/// Every body must be the child of one hinge, and all of them hang on the world. \returns false after reporting.
bool check_topology(const std::vector<std::string>& bodies, const std::vector<Link>& links, const Checker& checker);

}  // namespace withy
