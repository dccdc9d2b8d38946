/// \file
/// Scenes in which one cause is planted, run to where they end.
#pragma once

#include <string>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::test {

/// Of a run, without what more would be said of a model that is sound.
inline RunSummary outcome_of(const SceneValues& values) {
  study::RunSettings settings;
  settings.look_beyond = false;
  return study::run(study::prepare(values, plugins()), plugins(), settings).summary;
}

inline RunSummary outcome_of_text(const std::string& rest) {
  return outcome_of(SceneValues::parse(
      "format: withy/1\nformulation: quadratic\nintegrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}\n" + rest,
      "planted.yaml"));
}

}  // namespace withy::test
