/// \file
/// What the tests of the scene room share: a registry with the project's plugins and one small good scene.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {

/// A good scene of a rigid body, a beam and a load. Tests change one thing in it; line numbers are in their
/// expectations.
inline constexpr const char* good_scene = R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1.0, output: 0.1}
bodies:
  hub:
    type: rigid
    mass: 20.0
    inertia: [0.01, 0.01, 0.01, 0, 0, 0]
    frames:
      out: {position: [0.0762, 0, 0]}
  boom:
    type: beam
    length: 0.9
    mass_per_length: 1.3
    bending_y: {stiffness: 112, modes: 2, family: clamped-free}
    damping_ratio: 0.01
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  root: {type: weld, parent: hub.out, child: boom}
loads:
  motor: {type: hinge-effort, hinge: shoulder, law: sine, amplitude: 20, period: 5}
)";

/// `text` with the first `from` replaced; `from` must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the good scene has no '" + from + "'");
  return text.replace(at, from.size(), to);
}

inline std::string file_text(const std::string& path) {
  std::ifstream stream(std::string(WITHY_SOURCE_DIRECTORY "/") + path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error("cannot read " + path);
  return text.str();
}

/// All messages of a bad scene; empty where it is good.
inline std::string problems(const std::string& text, Registry& registry, const SceneOptions& options = {}) {
  try {
    parse_scene(text, "s.yaml", registry, options);
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

class SceneTest : public testing::Test {
 protected:
  SceneTest() { enroll_static_plugins(registry); }
  Registry registry;
};

}  // namespace withy::test
