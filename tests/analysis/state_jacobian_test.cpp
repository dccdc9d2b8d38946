/// \file
/// The exact ∂ẏ/∂y against differences of the sweeps, another algorithm, on random trees.
#include <gtest/gtest.h>

#include <algorithm>

#include "analysed_scene.hpp"

namespace withy::test {
namespace {

/// ẏ without the work element.
Eigen::VectorXd rates(const AnalysedScene& c, const std::vector<double>& y, Work& work) {
  std::vector<double> f(y.size());
  EXPECT_TRUE(c.equations->derivatives(0.3, y, f, work).ok());
  return Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size()) - 1);
}

/// d rates / ds of y + s d, quaternions scaled to unit length, by central differences of sixth order: with
/// s = 1e-4 their error is 1e-24 of the seventh derivative, and rounding 1e-12 of what is differentiated.
Eigen::VectorXd along(const AnalysedScene& c, const std::vector<double>& d) {
  Work work = c.equations->make_work();
  const auto at = [&](double s) {
    std::vector<double> y = c.state.y;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += s * d[i];
    c.equations->normalize(y);
    return rates(c, y, work);
  };
  const double h = 1e-4;
  return (45 * (at(h) - at(-h)) - 9 * (at(2 * h) - at(-2 * h)) + (at(3 * h) - at(-3 * h))) / (60 * h);
}

/// Along every speed, and along the change of positions that every speed makes (of a quaternion, along its sphere).
void expect_jacobian(const AnalysedScene& c, const std::string& what) {
  const Linearization* linearization = c.equations->linearization();
  ASSERT_NE(linearization, nullptr);
  const std::size_t size = c.equations->size(), positions = c.layout().positions;
  const auto m = static_cast<Eigen::Index>(size) - 1;
  if (m == 0) return;
  Work work = c.equations->make_work();
  std::vector<double> y_dot(size);
  ASSERT_TRUE(c.equations->derivatives(0.3, c.state.y, y_dot, work).ok());
  Eigen::MatrixXd J(m, m);
  ASSERT_TRUE(linearization->jacobian(0.3, c.state.y, y_dot, {J.data(), static_cast<std::size_t>(J.size())}).ok());
  for (std::size_t k = 0; k < c.layout().speeds; ++k) {
    std::vector<double> speed(size, 0.0), y = c.state.y, displacement(size);
    speed[positions + k] = 1;
    for (std::size_t i = 0; i < c.layout().speeds; ++i) y[positions + i] = i == k ? 1 : 0;
    ASSERT_TRUE(c.equations->position_rates(0.3, y, displacement, work).ok());
    for (std::size_t i = positions; i < size; ++i) displacement[i] = 0;
    for (const std::vector<double>* d : {&speed, &displacement}) {
      const Eigen::VectorXd expected = along(c, *d);
      const Eigen::VectorXd given = J * Eigen::Map<const Eigen::VectorXd>(d->data(), m);
      EXPECT_LT((expected - given).cwiseAbs().maxCoeff(), 1e-8 * (1 + J.cwiseAbs().maxCoeff()))
          << what << (d == &speed ? " u " : " δ ") << c.layout().speed_names[k] << "\n"
          << expected.transpose() << "\n"
          << given.transpose();
    }
  }
}

class JacobianOf : public testing::TestWithParam<std::string> {};

// Near a zero of det M, where strict forms have a pole, differences tell nothing: those trees are left out.
TEST_P(JacobianOf, random_trees_is_the_derivative_of_the_sweeps) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const AnalysedScene c(seed, {.bodies = 2 + static_cast<int>(seed % 4), .planar = seed % 2 == 0}, GetParam());
    if (conditioning(c.equations->system(0.3, c.state.y)).smallest_eigenvalue <= 0) continue;
    expect_jacobian(c, "seed " + std::to_string(seed));
    ++compared;
  }
  EXPECT_GE(compared, 6);
}

// Quaternions, loads at frames and hinges, a prescribed motion.
TEST_P(JacobianOf, loads_and_motions_is_the_derivative_of_the_sweeps) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
gravity: [0.3, -2, 1]
bodies:
  base: {type: rigid, mass: 2, inertia: [0.1, 0.2, 0.3, 0, 0, 0], frames: {out: {position: [0.2, 0, 0.1]}}}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2}, damping_ratio: 0.02}
  wheel: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  fly: {type: free, parent: world, child: base}
  slew: {type: revolute, axis: [0, 0.6, 0.8], parent: base.out, child: boom}
  axle: {type: revolute, axis: [0, 1, 0], parent: boom.tip, child: wheel}
motions:
  turn: {type: sine, hinge: axle, amplitude: 0.3, period: 1}
loads:
  push: {type: force, frame: boom.tip, following: true, law: constant, value: [-1, 2, 0.5]}
  stay: {type: spring-damper, frame: boom.tip, anchor: [3, 0.2, 0], stiffness: 20, damping: 5, free_length: 1.8}
  hold: {type: hinge-spring, hinge: slew, stiffness: 5, damping: 0.2}
)",
                  GetParam());
  RandomScene random(3, {});
  c.state = random.state(*c.scene.model, c.scene.initial);
  expect_jacobian(c, "loads");
  EXPECT_EQ(c.equations->linearization()->differenced(0.3, c.state.y), (std::vector<std::string>{"push", "stay"}));
}

INSTANTIATE_TEST_SUITE_P(Formulations, JacobianOf, testing::ValuesIn(all_formulations), [](const auto& parameter) {
  std::string name = parameter.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace withy::test
