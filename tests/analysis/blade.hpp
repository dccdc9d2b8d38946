/// \file
/// A uniform cantilever of unit length, mass and bending stiffness on a turning axle: the rotating beam of the
/// literature.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "analysed_scene.hpp"
#include "withy/core/analysis/modes.hpp"

namespace withy::test {

/// Lag is bending_y, in the plane of rotation; flap is bending_z. Extra lines go among the bodies and hinges.
inline std::string blade(int lag, int flap, const std::string& bodies = "", const std::string& hinges = "",
                         const std::string& gravity = "[0, 0, 0]", const std::string& family = "clamped-free") {
  return "format: withy/1\ntime: {end: 1}\ngravity: " + gravity +
         "\nbodies:\n  blade: {type: beam, length: 1, mass_per_length: 1" +
         (lag > 0 ? ", bending_y: {stiffness: 1, modes: " + std::to_string(lag) + ", family: " + family + "}" : "") +
         (flap > 0 ? ", bending_z: {stiffness: 1, modes: " + std::to_string(flap) + ", family: " + family + "}" : "") +
         "}\n" + bodies + "hinges:\n" +
         (hinges.empty() ? "  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: blade}\n" : hinges);
}

/// Holds the hinges named.
inline Held hold(const AnalysedScene& c, const std::vector<std::string>& hinges) {
  Held held(c.layout().speeds, false);
  for (const std::string& name : hinges) {
    const Slot& slot = *c.layout().hinge(name);
    for (std::size_t i = 0; i < slot.speeds; ++i) held[slot.speed + i] = true;
  }
  return held;
}

/// Tangents of the steady state that the scene's state leads to.
inline Tangents steady_tangents(AnalysedScene& c, const Held& held) {
  const SteadyState steady = find_steady_state(*c.dynamics, c.state, held);
  EXPECT_TRUE(steady.converged);
  c.state = steady.state;
  return c.dynamics->tangents(0, c.state.y, Eigen::VectorXd::Zero(c.speeds()));
}

inline std::vector<Mode> steady_modes(AnalysedScene& c, const std::vector<std::string>& held) {
  return natural_modes(steady_tangents(c, hold(c, held)), hold(c, held));
}

/// The modes that a group of coordinates, as "bending_y", dominates.
inline std::vector<Mode> of_group(const AnalysedScene& c, const std::vector<Mode>& modes, const std::string& group) {
  std::vector<Mode> found;
  for (const Mode& m : modes) {
    if (c.layout().speed_names[static_cast<std::size_t>(m.dominant)].find(group) != std::string::npos)
      found.push_back(m);
  }
  // The order of the closed forms: by squared frequency, negative where a mode grows.
  std::stable_sort(found.begin(), found.end(),
                   [](const Mode& a, const Mode& b) { return a.squared_frequency() < b.squared_frequency(); });
  return found;
}

}  // namespace withy::test
