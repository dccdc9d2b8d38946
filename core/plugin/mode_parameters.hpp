/// \file
/// The numbers of modes that a scene gives a body: found by the roles of parameters, whatever plugin and keys they
/// have.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// A number of modes in the value of a body.
struct ModeCount {
  std::string path;    ///< below the body, as "bending_y.modes"
  std::string strain;  ///< what the modes are of: path without its last key, as "bending_y"; empty: the whole body
  std::size_t modes = 0;
  std::size_t least = 0, most = 0;  ///< allowed
  std::string family_path;          ///< of the bending family beside it, as "bending_y.family"; empty: none
  Value family;  ///< the family given, of bending or another strain: a name, or a map with `name`; null: none
  /// The family's id; empty where there is none.
  [[nodiscard]] std::string family_id() const;
};

/// All of them, in the order of the parameters, which is that of the body's modal coordinates.
/// \param body checked value
std::vector<ModeCount> mode_counts(const Value& body, const std::vector<ParameterSpec>& specs);

}  // namespace withy
