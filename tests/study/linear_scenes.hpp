/// \file
/// Scenes in words for tests of linear models.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/study/configuration.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {

/// The scene of a text without its format and its time, which is one second; some values changed.
inline Prepared scene_of(const std::string& text, const std::vector<std::string>& changes = {}) {
  SceneValues values = SceneValues::parse("format: withy/1\ntime: {end: 1}\n" + text, "text");
  for (const std::string& change : changes) values.set_text(change);
  return prepare(std::move(values), test::plugins());
}

/// Where it begins.
inline Configuration at_start(const Prepared& prepared) { return {prepared, prepared.scene.initial, {}}; }

/// Index of a name among columns.
inline Eigen::Index find(const std::vector<Column>& columns, const std::string& name) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return static_cast<Eigen::Index>(i);
  ADD_FAILURE() << "no " << name;
  return 0;
}

/// A rigid body in free space with a push beside its centre of mass, a turn and instruments.
inline const std::string free_body = R"(
bodies: {bus: {type: rigid, mass: 4, inertia: [3, 3, 5, 0, 0, 0], frames: {arm: {position: [0.5, 0, 0]}}}}
hinges: {float: {type: free, parent: world, child: bus}}
loads:
  push: {type: input, frame: bus.arm, direction: [0, 2, 0]}
  turn: {type: input, frame: bus, direction: [0, 0, 1], acts: torque}
outputs:
  box: {type: accelerometer, of: bus.arm}
  rate: {type: gyro, of: bus}
  place: {type: frame, of: bus, show: position}
)";

/// A controller with an integral that holds a beam by its heavy hub; the beam vibrates a million times faster than
/// anything else.
inline const std::string heavy_hub = R"(
gravity: [0, 0, -9.81]
bodies:
  hub: {type: rigid, mass: 1.0e6, inertia: [1.0e8, 1.0e8, 1.0e8, 0, 0, 0]}
  beam: {type: beam, length: 2, mass_per_length: 1, bending_z: {stiffness: 1.0e+10, modes: 6}}
hinges:
  root: {type: revolute, axis: [0, 1, 0], parent: world, child: hub}
  weld: {type: weld, parent: hub, child: beam}
loads: {servo: {type: pid, hinge: root, proportional: 300, integral: 200, derivative: 60, filter: 0.02}}
)";

}  // namespace withy::study
