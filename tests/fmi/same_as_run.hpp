/// \file
/// What an FMU gives against the table of a run.
#pragma once

#include <cmath>
#include <functional>

#include "withy/tests/fmi/importer.hpp"

namespace withy::test {

inline const std::string jets = SCENES "/attitude-jets.yaml";

/// The scene's run with a tighter tolerance than what is measured against it; its last row is at `end`.
inline host::Result exact_run(const std::string& file, double end) {
  host::Scene scene = host::Scene::read(library(), file);
  scene.set("time.end", end).set("time.output", end);
  scene.set("integrator.rtol", 1e-10).set("integrator.atol", 1e-12);
  return scene.run();
}

/// All outputs but the work, by the tables of a run.
inline void expect_same(const Unpacked& fmu, const std::function<double(std::uint32_t)>& get, const host::Result& run,
                        std::size_t row, double tolerance) {
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    const std::string& name = run.columns[c].name;
    if (name == "work") continue;
    const double want = run.values[row * run.columns.size() + c];
    EXPECT_NEAR(get(fmu.reference(name)), want, tolerance * (1 + std::abs(want))) << name << " in row " << row;
  }
}

}  // namespace withy::test
