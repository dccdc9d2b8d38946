/// \file
/// What tests of sensors share: loads at frames, and states along a motion.
#pragma once

#include <array>
#include <sstream>

#include "random_case.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy::test {

inline Vector3 arrow(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Loads at frames of a random tree, dead ones and ones that follow.
inline std::string frame_loads(unsigned seed, int bodies) {
  std::ostringstream text;
  const std::string last = "b" + std::to_string(bodies - 1), middle = "b" + std::to_string(bodies / 2);
  text << "loads:\n  dead: {type: force, frame: " << last << ".m, law: constant, value: [" << seed % 3 << ", 2, "
       << (seed % 5) - 2.0 << "]}\n  follower: {type: force, frame: " << middle
       << ".a, following: true, law: constant, value: [1.5, -0.7, 0.4]}\n  twist: {type: torque, frame: " << last
       << ".a, law: constant, value: [0.2, 0.3, -0.6]}\n  rod: {type: spring-damper, frame: " << last
       << ".a, to: b0.m, stiffness: 3, damping: 0.4, free_length: 0.2}\n";
  return text.str();
}

/// The state moved along its own motion: every quantity of it then has its rate in time.
inline State moved(const Case& c, double by) {
  State s = c.state;
  const std::vector<double> rates = c.derivatives(c.state);
  s.time += by;
  for (std::size_t i = 0; i < rates.size(); ++i) s.y[i] += by * rates[i];
  return s;
}

}  // namespace withy::test
