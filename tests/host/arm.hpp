/// \file
/// A library for tests of hosts, and a scene that has everything a host meets.
#pragma once

#include <string>

#include "withy/host/scene.hpp"

namespace withy::test {

inline const host::Library& library() {
  static const host::Library made;
  return made;
}

/// A flexible arm with inputs of every kind, a sampled controller, a load that jumps, and events.
inline const std::string busy_arm = R"(format: withy/1
gravity: [0, 0, -3]
time: {end: 1, output: 0.05}
integrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}, damping_ratio: 0.01}
hinges:
  base: {type: free, parent: world, child: hub}
  axle: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
loads:
  torque: {type: input, hinge: axle}
  ramp: {type: input, hinge: base, component: 5, hold: linear}
  jet: {type: input, frame: boom.tip, direction: [0, 1, 0], following: true}
  hold: {type: pd-controller, law: constant, sample: 0.03, hinges: {axle: {to: 0.3, stiffness: 1, damping: 0.2}}}
  kick: {type: hinge-effort, hinge: axle, law: steps, table: [[0.22, 0.1], [0.31, 0]]}
events:
  forth: {hinge: axle, value: 0.05}
  halt: {hinge: axle, value: 0.1, direction: up, stop: true}
)";

/// The same without what changes at instants.
inline host::Scene smooth_arm() {
  std::string text = busy_arm;
  const std::size_t first = text.find("  hold: {type: pd"), last = text.find("  kick:");
  text.erase(first, last - first);
  return host::Scene::parse(library(), text);
}

}  // namespace withy::test
