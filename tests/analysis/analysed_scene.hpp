/// \file
/// A scene with its equations and their derivatives.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/tangents/tangent_dynamics.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/dynamics/random_scene.hpp"

namespace withy::test {

inline const std::vector<std::string> all_formulations = {"ruthless",    "inconsistent", "consistent",
                                                          "quadratic",   "linear",       "exact",
                                                          "rate-linear", "symmetric",    "symmetric-linear"};

struct AnalysedScene {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  std::unique_ptr<TangentDynamics> dynamics;
  State state;

  explicit AnalysedScene(const std::string& text, const std::string& formulation,
                         std::vector<std::string> overrides = {}) {
    enroll_static_plugins(registry);
    scene = parse_scene(text, "text", registry, {formulation, "", std::move(overrides)});
    equations = scene.formulation->compile(scene.model);
    dynamics = std::make_unique<TangentDynamics>(scene.model, scene.formulation->terms());
    state = scene.initial;
  }
  AnalysedScene(unsigned seed, const SceneWish& wish, const std::string& formulation)
      : AnalysedScene(RandomScene(seed, wish).text(), formulation) {
    RandomScene random(seed, wish);
    state = random.state(*scene.model, scene.initial);
  }
  [[nodiscard]] const Layout& layout() const { return scene.model->layout(); }
  [[nodiscard]] Eigen::Index speeds() const { return static_cast<Eigen::Index>(layout().speeds); }
  [[nodiscard]] Eigen::Index speed(const std::string& hinge_or_body) const {
    const Slot* slot = layout().hinge(hinge_or_body);
    if (slot == nullptr) slot = layout().body(hinge_or_body);
    return static_cast<Eigen::Index>(slot->speed);
  }
  /// Sets the rate of a hinge with one.
  void spin(const std::string& hinge, double rate) {
    state.y[layout().positions + layout().hinge(hinge)->speed] = rate;
  }
};

}  // namespace withy::test
