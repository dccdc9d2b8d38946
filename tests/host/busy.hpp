/// \file
/// The busy arm, driven as a host does.
#pragma once

#include <cmath>
#include <vector>

#include "withy/host/simulation.hpp"
#include "withy/tests/host/arm.hpp"

namespace withy::test {

inline host::Scene busy_scene() { return host::Scene::parse(library(), busy_arm); }

/// Steps with inputs that depend on nothing but the step: all outputs after each, one row behind the other.
inline std::vector<double> drive(host::Simulation& simulation, int first, int last) {
  std::vector<double> rows;
  for (int k = first; k < last; ++k) {
    simulation.set_input("torque", 0.2 * std::sin(0.7 * k));
    if (k % 2 == 0) simulation.set_input("ramp", 3 + 0.5 * std::cos(k));
    if (k == 4) simulation.set_input("jet", -0.3);
    simulation.step(0.04 * (k + 1));
    const auto now = simulation.output_values();
    rows.insert(rows.end(), now.begin(), now.end());
  }
  return rows;
}

}  // namespace withy::test
