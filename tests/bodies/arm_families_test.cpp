/// \file
/// The table of docs/mode-families.md: which modes the links of the two-link arm are best described with.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "withy/core/plugin/formulation.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {
namespace {

struct Arm {
  double condition;             ///< of M, all hinges free
  Eigen::VectorXd frequencies;  ///< [rad/s], hinges locked, elbow straight
};

Arm arm(const std::string& first, const std::string& second, int modes) {
  Registry registry;
  enroll_static_plugins(registry);
  const std::string count = std::to_string(modes);
  const Scene scene = read_scene(SCENES "/two-link-slew.yaml", registry,
                                 {"quadratic",
                                  "",
                                  {"bodies.link1.bending_y.family=" + first, "bodies.link2.bending_y.family=" + second,
                                   "bodies.link1.bending_y.modes=" + count, "bodies.link2.bending_y.modes=" + count}});
  const auto equations = scene.formulation->compile(scene.model);
  const State straight = scene.model->reference_state();
  const DenseSystem system = equations->system(0, straight.y);
  const auto size = static_cast<Eigen::Index>(system.size);
  const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(system.mass.data(), size, size);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  std::vector<Eigen::Index> elastic;
  for (const Slot& slot : scene.model->layout().bodies) {
    const auto at = static_cast<Eigen::Index>(slot.speed);
    const BodyNode& body = scene.model->bodies()[static_cast<std::size_t>(scene.model->body(slot.name))];
    K.block(at, at, modes, modes) = body.body->shape().stiffness;
    for (Eigen::Index i = 0; i < modes; ++i) elastic.push_back(at + i);
  }
  // The greatest 1/ω²: the lowest frequencies without loss to the highest.
  const Eigen::MatrixXd m = M(elastic, elastic), k = K(elastic, elastic);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m, k);
  return {conditioning(system).condition, eigen.eigenvalues().reverse().cwiseSqrt().cwiseInverse()};
}

const std::string free = "clamped-free";
const std::string with_motor = "{name: clamped-loaded, tip_mass: 14, tip_inertia: 0.03, tip_offset: 0.0762}";
const std::string with_payload = "{name: clamped-loaded, tip_mass: 2, tip_inertia: 0.01, tip_offset: 0.0508}";
const std::string with_all = "{name: clamped-loaded, tip_mass: 16.61236, tip_inertia: 2.128392, tip_offset: 0.2232357}";

/// Another basis that knows nothing of the tip, far converged.
TEST(ArmFamilies, frequencies_of_the_table_are_converged) {
  const Arm polynomials = arm("orthogonal-polynomials", "orthogonal-polynomials", 9);
  const double table[] = {2.97990, 7.30578, 57.6095, 110.040};
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(polynomials.frequencies[i] / table[i], 1, 1e-5) << i;
}

/// Rows 2 and 6 of the table, to 10 %: two loaded modes are nearer than six free ones, and M is a hundred times better.
TEST(ArmFamilies, two_loaded_modes_are_worth_more_than_six_free_ones) {
  const double exact[] = {2.9798978745, 7.3057797038, 57.609508967, 110.03961859};
  const Arm six_free = arm(free, free, 6), two_loaded = arm(with_motor, with_payload, 2);
  const Arm all_outboard = arm(with_all, with_payload, 2);
  const double of_free[] = {6.4e-3, 3.7e-3, 5.1e-2, 5.8e-2}, of_loaded[] = {8.4e-4, 1.6e-3, 2.0e-3, 1.5e-2};
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR((six_free.frequencies[i] / exact[i] - 1) / of_free[i], 1, 0.1) << i;
    EXPECT_NEAR((two_loaded.frequencies[i] / exact[i] - 1) / of_loaded[i], 1, 0.1) << i;
  }
  EXPECT_NEAR((all_outboard.frequencies[2] / exact[2] - 1) / 2.5e-4, 1, 0.1);
  EXPECT_NEAR(six_free.condition / 2.1e8, 1, 0.1);
  EXPECT_NEAR(two_loaded.condition / 1.0e5, 1, 0.1);
}

}  // namespace
}  // namespace withy::test
