/// \file
/// A wind turbine: a flexible tower, a nacelle that overhangs, and equal blades on a shaft.
#pragma once

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

namespace withy::test {

/// Blades 1 … n at equal angles about x, the first upwards. `extra` goes to the end of the scene.
inline std::string rotor(int blades, const std::string& extra = "", const std::string& gravity = "[0, 0, 0]") {
  std::ostringstream text;
  text.precision(17);
  text << "format: withy/1\ntime: {end: 5}\ngravity: " << gravity << R"(
bodies:
  tower:
    {type: beam, length: 87.6, mass_per_length: 4000, damping_ratio: 0.01,
     bending_y: {stiffness: 3.0e11, modes: 2}, bending_z: {stiffness: 3.0e11, modes: 2}}
  nacelle:
    {type: rigid, mass: 240e3, inertia: [4e6, 2.6e6, 2.6e6, 0, 0, 0], frames: {shaft: {position: [-5, 0, 2]}}}
  hub:
    type: rigid
    mass: 56780
    inertia: [115926, 115926, 115926, 0, 0, 0]
    frames:
)";
  const double half = std::sqrt(0.5);
  for (int k = 0; k < blades; ++k) {
    // A turn by `angle` about x, then one of −90° about y: the blade's x axis points away from the shaft.
    const double angle = 2 * std::numbers::pi * k / blades, c = std::cos(angle / 2), s = std::sin(angle / 2);
    text << "      b" << k + 1 << ": {position: [0, " << -1.5 * std::sin(angle) << ", " << 1.5 * std::cos(angle)
         << "], orientation: [" << half * c << ", " << half * s << ", " << -half * c << ", " << -half * s << "]}\n";
  }
  for (int k = 0; k < blades; ++k)
    text << "  blade" << k + 1 << R"(:
    type: beam
    length: 61.5
    mass_per_length: [[0, 700], [20, 350], [40, 200], [61.5, 15]]
    bending_y: {stiffness: [[0, 1.8e10], [10, 7e9], [30, 2.7e9], [50, 5e8], [61.5, 1e7]], modes: 2, family: orthogonal-polynomials}
    bending_z: {stiffness: [[0, 1.8e10], [10, 5e9], [30, 7e8], [50, 6e7], [61.5, 2e5]], modes: 2, family: orthogonal-polynomials}
    damping_ratio: 0.005
)";
  text << R"(hinges:
  foot: {type: weld, parent: world, child: tower, offset: {orientation: [0.7071067811865476, 0, -0.7071067811865476, 0]}}
  yaw: {type: weld, parent: tower.tip, child: nacelle, offset: {orientation: [0.7071067811865476, 0, 0.7071067811865476, 0]}}
  shaft: {type: revolute, axis: [1, 0, 0], parent: nacelle.shaft, child: hub}
)";
  for (int k = 1; k <= blades; ++k)
    text << "  root" << k << ": {type: weld, parent: hub.b" << k << ", child: blade" << k << "}\n";
  return text.str() + extra;
}

}  // namespace withy::test
