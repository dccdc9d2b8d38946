/// \file
/// What the reduction needs of a finite-element mesh: the places of its nodes and the names of node sets.
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy::fem {

/// A file that cannot be used: what() names it, the line where there is one, what was got and what is needed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Mesh {
  std::map<long, Vector3> nodes;                  ///< by number [m]
  std::map<std::string, std::vector<long>> sets;  ///< by name in capitals: input decks do not tell cases apart
};

/// Reads nodes and node sets of an input deck of CalculiX or Abaqus (`.inp`), or the nodes of a result file of CalculiX
/// (`.frd`, whose places have 6 digits).
/// \throws InputError
Mesh read_mesh(const std::filesystem::path& file);

/// Numbers of the nodes that a text names: a set, or numbers separated by commas.
/// \throws InputError where there is no such set or node.
std::vector<long> nodes_of(const Mesh& mesh, const std::string& text);

}  // namespace withy::fem
