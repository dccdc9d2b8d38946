/// \file
/// Scenes compiled in a formulation, random ones in random states.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "random_scene.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {

struct Case {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  State state;

  Case(const std::string& text, const std::string& formulation) {
    enroll_static_plugins(registry);
    scene = parse_scene(text, "text", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    state = scene.initial;
  }
  Case(unsigned seed, const SceneWish& wish, const std::string& formulation) {
    enroll_static_plugins(registry);
    RandomScene random(seed, wish);
    scene = parse_scene(random.text(), "random", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    state = random.state(*scene.model, scene.initial);
  }
  /// A scene file as it is.
  explicit Case(const std::filesystem::path& file) {
    enroll_static_plugins(registry);
    scene = read_scene(file, registry);
    equations = scene.formulation->compile(scene.model);
    state = scene.initial;
  }
  std::vector<double> derivatives(const State& s) const {
    std::vector<double> y_dot(equations->size());
    Work work = equations->make_work();
    work.poison();
    EXPECT_TRUE(equations->derivatives(s.time, s.y, y_dot, work).ok());
    return y_dot;
  }
};

inline const std::vector<std::string> formulations = {"ruthless",    "inconsistent", "consistent",
                                                      "quadratic",   "linear",       "exact",
                                                      "rate-linear", "symmetric",    "symmetric-linear"};
/// For names of parametrized tests.
inline std::string formulation_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace withy::test
