/// \file
/// Runs of scenes of the gallery.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {

/// A scene run to its end, some values changed, without an estimate.
inline CertifiedRun run_of(const std::string& name, const std::vector<std::pair<std::string, Value>>& changes,
                           const std::string& formulation) {
  SceneValues values = scene(name);
  for (const auto& [path, value] : changes) values.set(path, value, "the test");
  const Prepared prepared = prepare(values.choose_formulation(formulation, "the test"), test::plugins());
  RunSettings settings;
  settings.estimate = Estimate::never;
  return run(prepared, test::plugins(), settings);
}

}  // namespace withy::study
