/// \file
/// A cantilever that carries a mass, and the load on a body at a state.
#pragma once

#include <string>
#include <vector>

#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/core/simulation/tree_motion.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {

/// Load ratio of a body at the initial state with these accelerations.
inline LoadRatio load_of(const Made& m, const std::string& body, const std::vector<double>& u_dot) {
  TreeMotion motion(*m.scene.model);
  motion.update(m.scene.initial.y, u_dot);
  FeltMotion felt(*m.scene.model, *m.equations);
  felt.update(m.scene.initial, motion.bodies());
  MotionStiffness stiffness(*m.scene.model, static_cast<std::size_t>(m.scene.model->body(body)));
  return stiffness.evaluate(felt.bodies(), felt.at_frames());
}

/// A cantilever along x of length 1, EI = 10, 1 kg, with a mass at its tip, welded to the world.
inline std::string cantilever(const std::string& gravity, double mass_per_length, double tip_mass,
                              const std::string& bending, const std::string& hinge = "weld") {
  return "format: withy/1\ntime: {end: 1}\ngravity: " + gravity +
         "\nbodies:\n  beam: {type: beam, length: 1, mass_per_length: " + std::to_string(mass_per_length) + ", " +
         bending + "}\n  tip: {type: rigid, mass: " + std::to_string(tip_mass) +
         ", inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n  h: {type: " + hinge +
         ", parent: world, child: beam}\n  t: {type: weld, parent: beam.tip, child: tip}\n";
}

}  // namespace withy::test
