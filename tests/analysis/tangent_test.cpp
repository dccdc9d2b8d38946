/// \file
/// The exact derivatives against the dense reference, which is another algorithm, on random trees.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "analysed_scene.hpp"

namespace withy::test {
namespace {

/// M a − f − τ from the dense reference.
Eigen::VectorXd dense_residual(const AnalysedScene& c, const std::vector<double>& y, const Eigen::VectorXd& a) {
  const DenseSystem s = c.equations->system(0.3, y);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index n = c.speeds();
  const auto vector = [&](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), n); };
  return Eigen::Map<const Rows>(s.mass.data(), n, n) * a - vector(s.force) - vector(s.applied);
}

/// f′(0) by central differences, extrapolated to step zero three times (Richardson): O(h⁸).
template <class Function>
Eigen::VectorXd extrapolated(Function&& f, double h) {
  std::vector<Eigen::VectorXd> row;
  for (int k = 0; k < 4; ++k) {
    const double step = h / (1 << k);
    Eigen::VectorXd better = (f(step) - f(-step)) / (2 * step);
    double power = 4;
    for (Eigen::VectorXd& before : row) {
      const Eigen::VectorXd next = better + (better - before) / (power - 1);
      before = better;
      better = next;
      power *= 4;
    }
    row.push_back(better);
  }
  return row.back();
}

Eigen::VectorXd some_accelerations(Eigen::Index n, unsigned seed) {
  Eigen::VectorXd a(n);
  for (Eigen::Index i = 0; i < n; ++i) a[i] = std::sin(1.0 + 3.0 * static_cast<double>(i) + seed);
  return a;
}

void expect_near(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double tolerance, const std::string& what) {
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance) << what << "\n" << a.transpose() << "\n" << b.transpose();
}

/// Derivatives of r along every displacement, speed and acceleration against differences of the reference's r. The
/// smallest step, 0.0025, leaves 1e-16/0.0025 = 4e-14 of rounding, of terms that may be 1e4 times as large as r.
void expect_derivatives(const AnalysedScene& c, unsigned seed) {
  const Eigen::Index n = c.speeds();
  if (n == 0) return;
  const Eigen::VectorXd a = some_accelerations(n, seed);
  const Tangents t = c.dynamics->tangents(0.3, c.state.y, a);
  const double scale = 1 + t.by_position.cwiseAbs().maxCoeff() + t.by_speed.cwiseAbs().maxCoeff();
  const std::string what = "seed " + std::to_string(seed);
  expect_near(t.residual, dense_residual(c, c.state.y, a), 1e-12 * scale, what);
  expect_near(t.residual, c.dynamics->residual(0.3, c.state.y, a), 1e-13 * scale, what);
  const auto displaced = [&](Eigen::Index j) {
    return extrapolated(
        [&](double h) {
          std::vector<double> y = c.state.y;
          c.dynamics->displace(y, h * Eigen::VectorXd::Unit(n, j));
          return dense_residual(c, y, a);
        },
        0.02);
  };
  const auto sped = [&](Eigen::Index j) {
    return extrapolated(
        [&](double h) {
          std::vector<double> y = c.state.y;
          y[c.layout().positions + static_cast<std::size_t>(j)] += h;
          return dense_residual(c, y, a);
        },
        0.02);
  };
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::string& name = c.layout().speed_names[static_cast<std::size_t>(j)];
    expect_near(t.by_position.col(j), displaced(j), 1e-9 * scale, what + " δ " + name);
    expect_near(t.by_speed.col(j), sped(j), 1e-9 * scale, what + " u " + name);
    expect_near(t.mass.col(j), dense_residual(c, c.state.y, a + Eigen::VectorXd::Unit(n, j)) - t.residual,
                1e-12 * scale, what + " a " + name);
  }
}

/// The dense equations of the kinetic energy's first order differentiate it twice, a hundred times the work: two trees
/// (the Jacobian is compared with the sweeps on more).
unsigned trees(const std::string& formulation, unsigned all) { return formulation.starts_with("symmetric") ? 2 : all; }

class TangentsOf : public testing::TestWithParam<std::string> {};

TEST_P(TangentsOf, random_trees_in_space_are_the_derivatives_of_the_dense_equations) {
  for (unsigned seed = 1; seed <= trees(GetParam(), 8); ++seed)
    expect_derivatives(
        AnalysedScene(seed, {.bodies = 2 + static_cast<int>(seed % 5), .any_root = seed % 2 == 0}, GetParam()), seed);
}

TEST_P(TangentsOf, random_trees_in_a_plane_are_the_derivatives_of_the_dense_equations) {
  for (unsigned seed = 1; seed <= trees(GetParam(), 10); ++seed)
    expect_derivatives(AnalysedScene(seed, {.bodies = 2 + static_cast<int>(seed % 5), .planar = true}, GetParam()),
                       seed);
}

TEST_P(TangentsOf, random_trees_of_every_family_are_the_derivatives_of_the_dense_equations) {
  for (unsigned seed = 1; seed <= trees(GetParam(), 6); ++seed)
    expect_derivatives(
        AnalysedScene(seed, {.bodies = 2 + static_cast<int>(seed % 4), .any_root = true, .any_family = true},
                      GetParam()),
        seed);
}

/// Loads that depend on the state, on hinges and at frames: dead, following, springs between deforming bodies.
TEST_P(TangentsOf, loads_are_the_derivatives_of_the_dense_equations) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
gravity: [0.3, -2, 1]
bodies:
  base: {type: rigid, mass: 2, inertia: [0.1, 0.2, 0.3, 0, 0, 0], frames: {out: {position: [0.2, 0, 0.1]}}}
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 2}, bending_z: {stiffness: 50, modes: 1}, torsion: {stiffness: 30, inertia: 0.003, modes: 1}}
hinges:
  ball: {type: spherical, parent: world, child: base}
  slew: {type: revolute, axis: [0, 0.6, 0.8], parent: base.out, child: boom}
loads:
  weight: {type: force, frame: boom.tip, law: constant, value: [1, -2, 3]}
  push: {type: force, frame: boom.tip, following: true, law: constant, value: [-1, 2, 0.5]}
  wheel: {type: torque, frame: boom.tip, following: true, law: constant, value: [0.1, 0.2, -0.3]}
  stay: {type: spring-damper, frame: boom.tip, anchor: [3, 0.2, 0], stiffness: 20, damping: 5, free_length: 1.8}
  tether: {type: spring-damper, frame: base, to: boom.tip, stiffness: 4, free_length: 0.3}
  jet: {type: thruster, frame: boom.tip, thrust: 2, direction: [0, 1, 0], firings: [[0, 3]]}
  hold: {type: hinge-spring, hinge: slew, stiffness: 5, damping: 0.2}
  rub: {type: hinge-friction, hinge: slew, effort: 0.5, rate_scale: 0.3}
)",
                  GetParam());
  RandomScene random(3, {});
  c.state = random.state(*c.scene.model, c.scene.initial);
  expect_derivatives(c, 3);
  const Tangents t = c.dynamics->tangents(0.3, c.state.y, some_accelerations(c.speeds(), 3));
  const std::vector<std::string> expected = {"push", "wheel", "stay", "tether", "jet"};
  EXPECT_EQ(t.differenced, expected) << "a dead force has no derivative to find numerically";
}

std::string name_of_formulation(const testing::TestParamInfo<std::string>& parameter) {
  std::string name = parameter.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Formulations, TangentsOf, testing::ValuesIn(all_formulations), name_of_formulation);

}  // namespace
}  // namespace withy::test
