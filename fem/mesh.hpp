/// \file
/// What the reduction needs of a finite-element mesh: its nodes and their sets; for the geometric stiffness its
/// elements and what they are made of.
#pragma once

#include <filesystem>
#include <map>
#include <set>
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

struct Element {
  std::string type;         ///< in capitals, as "C3D20R"
  std::vector<long> nodes;  ///< in the deck's order
};

/// A linear isotropic material.
struct Elastic {
  double modulus = 0;        ///< Young's [N/m²]
  double poisson_ratio = 0;  ///< [1]
};

/// Elements made of a material. *SOLID SECTION.
struct SolidSection {
  std::string elements, material;  ///< names, in capitals
};

/// Names are in capitals: input decks do not tell cases apart.
struct Mesh {
  std::map<long, Vector3> nodes;                          ///< by number [m]
  std::map<std::string, std::vector<long>> sets;          ///< of nodes
  std::map<long, Element> elements;                       ///< by number, of types that element_shape() knows
  std::map<long, Element> drawn_only;                     ///< by number, of types that element_faces() knows alone
  std::set<std::string> other_elements;                   ///< types that neither knows
  std::map<std::string, std::vector<long>> element_sets;  ///< numbers of elements
  std::map<std::string, Elastic> materials;               ///< those that are linear and isotropic
  std::vector<SolidSection> sections;
};

/// Reads an input deck of CalculiX or Abaqus (`.inp`), or the nodes of a result file of CalculiX
/// (`.frd`, whose places have 6 digits).
/// \throws InputError
Mesh read_mesh(const std::filesystem::path& file);

/// Numbers of the nodes that a text names: a set, or numbers separated by commas.
/// \throws InputError where there is no such set or node.
std::vector<long> nodes_of(const Mesh& mesh, const std::string& text);

}  // namespace withy::fem
