/// \file
/// Blades and towers of OpenFAST's ElastoDyn: tables of distributed properties to beams.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy {
class Body;
}

namespace withy::exchange {

/// A blade or tower file (ElastoDyn 1.00 and later, FAST 7), with its adjustment factors applied. The beam's axes x, y,
/// z are OpenFAST's z, x, y of the same part: `along_y` is flapwise or fore-aft, `along_z` edgewise or side to side.
struct ElastoDynBeam {
  bool tower = false;
  std::string title;
  std::vector<double> fraction;          ///< of the length, from 0 to 1
  std::vector<double> mass_per_length;   ///< [kg/m]
  std::vector<double> along_y, along_z;  ///< bending stiffness of deflections along y and z [N m²]
  std::vector<double> twist;             ///< of the sections about x [rad], less than zero towards feather; tower: none
  /// Of critical: of the first modes in each direction, as many as the file tells of, one at least.
  std::vector<double> damping_y, damping_z;
  std::map<int, double> ratios;      ///< of the beam's modes, from 1, whose damping is not that of the first along y
  std::vector<std::string> remarks;  ///< what has no place in a beam, a sentence each
};

/// \throws SceneError with every problem and its line.
ElastoDynBeam read_elastodyn(std::string_view text, const std::string& file);

/// Sets `ratios`, and tells of them: which of the beam's own modes are the file's, by the direction that they move in.
/// \param body made of the beam
void assign_damping(ElastoDynBeam& beam, const Body& body);

/// A scene of the beam, clamped at its root, of this length [m], with a rigid mass [kg] at its tip where there is one.
std::string scene_text(const ElastoDynBeam& beam, double length, double tip_mass, const std::string& source);

}  // namespace withy::exchange
