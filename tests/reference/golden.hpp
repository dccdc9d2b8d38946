/// \file
/// The golden data of tests/reference: states and the equations of motion there, by an independent brute-force
/// program (explicit Jacobians, strict truncation by complex-step derivatives), good to about 1e-12.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {

inline const std::vector<std::string> golden_scenes = {"arm-1", "arm-2", "arm-4", "beam-on-base", "spacecraft"};
inline const std::vector<std::string> golden_formulations = {"ruthless", "inconsistent", "consistent", "quadratic"};

inline nlohmann::json golden(const std::string& name) {
  std::ifstream file(std::string(REFERENCE_DATA) + "/" + name + ".json");
  return nlohmann::json::parse(file);
}

/// A scene of this folder, compiled, with the plugins linked in.
struct CompiledScene {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;

  CompiledScene(const std::string& name, const std::string& formulation) {
    enroll_static_plugins(registry);
    scene = read_scene(std::string(REFERENCE_DATA) + "/" + name + ".yaml", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
  }
  [[nodiscard]] State state(const nlohmann::json& form) const {
    return parse_state(form.dump(), "state", *scene.model, scene.initial);
  }
};

}  // namespace withy::test
