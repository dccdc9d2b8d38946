/// \file
/// `eval` against the golden data, and the sweeps against the dense reference.
#include "golden.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace withy::test {
namespace {

class Golden : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

double largest(const std::vector<double>& a) {
  double m = 0;
  for (const double x : a) m = std::max(m, std::abs(x));
  return m;
}

TEST_P(Golden, mass_matrix_force_accelerations_energies_and_momenta_agree) {
  const auto& [name, formulation] = GetParam();
  const CompiledScene compiled(name, formulation);
  const EquationsOfMotion& equations = *compiled.equations;
  const nlohmann::json data = golden(name);
  ASSERT_EQ(equations.layout().speed_names, data["coordinates"].get<std::vector<std::string>>());
  ASSERT_FALSE(data["cases"].empty());
  for (const nlohmann::json& given : data["cases"]) {
    const State state = compiled.state(given["state"]);
    const nlohmann::json& expected = given["expected"][formulation];
    const DenseSystem system = equations.system(0, state.y);
    const std::size_t n = system.size;

    // Relative to the units of row and column: sqrt(M_ii M_jj).
    const auto mass = expected["mass_matrix"].get<std::vector<std::vector<double>>>();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        const double scale = std::sqrt(std::abs(mass[i][i] * mass[j][j]));
        EXPECT_NEAR(system.mass[i * n + j], mass[i][j], 1e-9 * scale) << i << ", " << j;
      }
    }
    const auto force = expected["force"].get<std::vector<double>>();
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(system.force[i], force[i], 1e-9 * largest(force)) << i;

    const auto accelerations = expected["accelerations"].get<std::vector<double>>();
    std::vector<double> y_dot(equations.size());
    Work work = equations.make_work();
    work.poison();
    ASSERT_TRUE(equations.derivatives(0, state.y, y_dot, work).ok());
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(y_dot[equations.layout().positions + i], accelerations[i], 1e-8 * largest(accelerations))
          << equations.layout().speed_names[i];
    }

    if (!expected.contains("kinetic_energy")) continue;
    const Energies e = equations.energies(state.y);
    EXPECT_NEAR(e.kinetic, expected["kinetic_energy"].get<double>(), 1e-9 * e.kinetic);
    const double potential = expected["potential_energy"].get<double>();
    EXPECT_NEAR(e.potential, potential, 1e-9 * std::abs(potential));
    const auto linear = expected["linear_momentum"].get<std::vector<double>>();
    const auto angular = expected["angular_momentum"].get<std::vector<double>>();
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(e.linear_momentum[c], linear[c], 1e-9 * largest(linear));
      EXPECT_NEAR(e.angular_momentum[c], angular[c], 1e-9 * largest(angular));
    }
  }
}

std::string case_name(const testing::TestParamInfo<Golden::ParamType>& info) {
  std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Data, Golden,
                         testing::Combine(testing::ValuesIn(golden_scenes), testing::ValuesIn(golden_formulations)),
                         case_name);

/// The kinetic energy to first order: by symmetric_arm.py of this folder, for the planar arms.
INSTANTIATE_TEST_SUITE_P(FirstOrder, Golden,
                         testing::Combine(testing::Values("arm-1", "arm-2", "arm-4"),
                                          testing::Values("symmetric", "symmetric-linear")),
                         case_name);

}  // namespace
}  // namespace withy::test
