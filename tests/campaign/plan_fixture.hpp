/// \file
/// Plans of the pendulum in a folder of their own.
#pragma once

#include <string>

#include "withy/campaign/plan.hpp"
#include "withy/tests/results/scratch.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::test {

struct PlanFolder : Scratch {
  /// Reads a plan of a short run of the pendulum; `more` is the rest of its file.
  campaign::Plan plan(const std::string& more) const {
    write("plan.yaml", "format: withy-sweep/1\nscene: " WITHY_SOURCES
                       "/scenes/pendulum.yaml\nset: {time.end: 0.5, integrator.rtol: 1e-6}\n" +
                           more);
    return campaign::read_plan((*this / "plan.yaml").string(), plugins());
  }
  /// What is wrong with such a plan.
  std::string errors(const std::string& more) const {
    try {
      static_cast<void>(plan(more));
    } catch (const SceneError& e) {
      return e.what();
    }
    return "nothing";
  }
};

}  // namespace withy::test
