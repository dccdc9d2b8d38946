/// \file
/// Mode families by id, for tests.
#pragma once

#include <string>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/conformance/mode_family_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {

inline std::unique_ptr<ModeFamily> family(const std::string& id, std::vector<Value::Member> options = {}) {
  Registry registry;
  enroll_static_plugins(registry);
  return make_plugin<ModeFamily>(registry, id, std::move(options));
}

inline BeamData bending_beam(double length = 1.0) { return {BeamData::Strain::bending, length, 1, 1}; }
inline BeamData torsion_rod(double length = 1.0) { return {BeamData::Strain::torsion, length, 1, 1}; }

/// Modes at which functions are compared one by one: the first, those around the twelfth, where the textbook form fails
/// in double precision, and the last.
inline constexpr int sampled_modes[] = {1, 2, 3, 5, 10, 12, 13, 20, 50, 100, 150, 199, 200};
inline constexpr double sampled_places[] = {0.0, 0.0078125, 0.3125, 0.5, 0.8125, 1.0};

}  // namespace withy::test
