/// \file
/// A scene made from text with its equations of motion.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {

struct Made {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  explicit Made(const std::string& text, const std::string& formulation = "") {
    enroll_static_plugins(registry);
    scene = parse_scene(text, "text", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
  }
  std::unique_ptr<EquationsOfMotion> in(const std::string& formulation) {
    return make_plugin<Formulation>(registry, formulation)->compile(scene.model);
  }
  std::vector<double> rates(const State& s) const {
    std::vector<double> y_dot(equations->size());
    Work work = equations->make_work();
    EXPECT_TRUE(equations->derivatives(s.time, s.y, y_dot, work).ok());
    return y_dot;
  }
};

}  // namespace withy::test
