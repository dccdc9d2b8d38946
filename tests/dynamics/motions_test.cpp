/// \file
/// Prescribed motions: the sweeps with driven hinges against the partitioned dense equations, on random trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "random_scene.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

struct Driven {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  State state;

  /// About half of the hinges that move are driven: those of one coordinate by a sine, the others are locked.
  Driven(unsigned seed, const SceneWish& wish, const std::string& formulation) {
    enroll_static_plugins(registry);
    RandomScene random(seed, wish);
    const Scene bare = parse_scene(random.text(), "random", registry, {formulation, "", {}});
    std::mt19937 choice(seed);
    std::ostringstream text;
    text << random.text() << "integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}\nmotions:\n";
    int driven = 0;
    for (const Slot& slot : bare.model->layout().hinges) {
      const bool wanted = std::uniform_int_distribution<int>(0, 1)(choice) == 0;
      if (slot.speeds == 0 || !wanted) continue;
      ++driven;
      text << "  m" << driven << ": {hinge: " << slot.name;
      if (slot.speeds == 1 && driven % 3 != 0) {
        text << ", type: sine, amplitude: 0.4, period: " << 0.5 + 0.1 * driven << ", phase: " << 0.3 * driven << "}\n";
      } else {
        text << ", type: locked}\n";
      }
    }
    if (driven == 0) text << "  {}\n";
    text << "loads:\n  push: {type: force, frame: b0.a, law: constant, value: [1, 2, " << (wish.planar ? 0 : 3)
         << "]}\n";
    scene = parse_scene(text.str(), "random", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    state = random.state(*scene.model, scene.initial);
    state.time = 0.37;
    scene.model->prescribe(state);
  }
  [[nodiscard]] bool is_driven(std::size_t speed) const {
    for (const MotionNode& m : scene.model->motions()) {
      const Slot& slot = scene.model->layout().hinges[static_cast<std::size_t>(m.hinge)];
      if (speed >= slot.speed && speed < slot.speed + slot.speeds) return true;
    }
    return false;
  }
};

class Motions : public testing::TestWithParam<std::string> {};

/// M u̇ = f + τ + λ with u̇ given and λ unknown on driven speeds, λ zero and u̇ unknown on the others. The residual is
/// taken against the size of the terms in each row, as in the tests of the free sweeps; `exact` in space turns sections
/// by another method than the reference, to 1e-8.
TEST_P(Motions, sweep_solves_the_partitioned_dense_equations) {
  const double tolerance = GetParam() == "exact" ? 1e-8 : 1e-11;
  int with_motions = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 6),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 2 == 0,
                         .any_family = seed % 4 >= 2};
    const Driven c(seed, wish, GetParam());
    if (c.scene.model->motions().empty()) continue;
    ++with_motions;
    const Layout& layout = c.equations->layout();
    const DenseSystem s = c.equations->system(c.state.time, c.state.y);
    Work work = c.equations->make_work();
    work.poison();
    std::vector<double> y_dot(c.equations->size()), motion(s.size, 7.0);
    const std::size_t before = allocations();
    ASSERT_TRUE(c.equations->derivatives(c.state.time, c.state.y, y_dot, work).ok()) << seed;
    ASSERT_TRUE(c.equations->motion_efforts(c.state.time, c.state.y, motion, work).ok()) << seed;
    EXPECT_EQ(allocations(), before);
    const double* a = y_dot.data() + layout.positions;
    std::vector<double> given(s.size);
    c.scene.model->prescribe_accelerations(c.state.time, given);
    double power = 0;
    for (std::size_t i = 0; i < s.size; ++i) {
      double residual = -s.force[i] - s.applied[i] - motion[i];
      double scale = std::abs(s.force[i]) + std::abs(s.applied[i]) + std::abs(motion[i]) + 1e-12;
      for (std::size_t j = 0; j < s.size; ++j) {
        residual += s.mass[i * s.size + j] * a[j];
        scale += std::abs(s.mass[i * s.size + j] * a[j]);
      }
      EXPECT_LT(std::abs(residual), tolerance * scale) << "seed " << seed << ", row " << layout.speed_names[i];
      if (c.is_driven(i)) {
        EXPECT_EQ(a[i], given[i]) << "seed " << seed << ", row " << layout.speed_names[i];
      } else {
        EXPECT_EQ(motion[i], 0) << "seed " << seed << ", row " << layout.speed_names[i];
      }
      power += (s.applied[i] + motion[i]) * c.state.y[layout.positions + i];
    }
    // The work of loads and motions, less what modal damping takes, is what the state counts.
    for (const BodyNode& body : c.scene.model->bodies()) {
      const Slot* slot = layout.body(body.name);
      if (slot == nullptr) continue;
      const Eigen::Map<const Eigen::VectorXd> rate(c.state.y.data() + layout.positions + slot->speed,
                                                   static_cast<Eigen::Index>(slot->speeds));
      power -= rate.dot(body.body->shape().damping * rate);
    }
    EXPECT_NEAR(y_dot.back(), power, 1e-7 * (1 + std::abs(power))) << "seed " << seed;
  }
  EXPECT_GE(with_motions, 25);
}

/// The solution of the dense system has the prescribed accelerations, and satisfies the free rows.
TEST_P(Motions, dense_solution_and_condition_are_those_of_the_free_speeds) {
  double hardest = 0;  // of what is prescribed: locked hinges alone would not show whether it acts on the others
  for (unsigned seed = 7; seed <= 12; ++seed) {
    const Driven c(seed, {.bodies = 6}, GetParam());
    const DenseSystem s = c.equations->system(c.state.time, c.state.y);
    if (s.prescribed.empty()) continue;
    const std::vector<double> a = solve(s);
    for (const PrescribedRate& p : s.prescribed) {
      EXPECT_EQ(a[p.speed], p.acceleration);
      hardest = std::max(hardest, std::abs(p.acceleration));
    }
    Work work = c.equations->make_work();
    std::vector<double> y_dot(c.equations->size());
    const Evaluation evaluation = c.equations->derivatives(c.state.time, c.state.y, y_dot, work);
    ASSERT_TRUE(evaluation.ok());
    double largest = 1;
    for (const double x : a) largest = std::max(largest, std::abs(x));
    for (std::size_t i = 0; i < s.size; ++i)
      EXPECT_NEAR(y_dot[c.equations->layout().positions + i], a[i], 1e-6 * largest) << i;
    EXPECT_EQ(determinant_sign(s), evaluation.determinant_sign);
    const Conditioning k = conditioning(s);
    ASSERT_EQ(k.weakest.size(), s.size);
    for (const PrescribedRate& p : s.prescribed) EXPECT_EQ(k.weakest[p.speed], 0);
    EXPECT_EQ(k.condition, conditioning(free_part(s)).condition);
  }
  EXPECT_GT(hardest, 1);
}

/// Inverse dynamics and products with M know of no motions.
TEST_P(Motions, do_not_change_inverse_dynamics) {
  const Driven c(9, {.bodies = 5}, GetParam());
  ASSERT_FALSE(c.scene.model->motions().empty());
  const DenseSystem s = c.equations->system(c.state.time, c.state.y);
  std::vector<double> a(s.size), efforts(s.size), product(s.size);
  for (std::size_t i = 0; i < s.size; ++i) a[i] = std::cos(2.0 * static_cast<double>(i));
  Work work = c.equations->make_work();
  c.equations->inverse_dynamics(c.state.y, a, efforts, work);
  c.equations->mass_times(c.state.y, a, product, work);
  for (std::size_t i = 0; i < s.size; ++i) {
    double expected = 0, scale = std::abs(s.force[i]) + 1e-12;
    for (std::size_t j = 0; j < s.size; ++j) {
      expected += s.mass[i * s.size + j] * a[j];
      scale += std::abs(s.mass[i * s.size + j] * a[j]);
    }
    EXPECT_NEAR(product[i], expected, 1e-8 * scale);
    EXPECT_NEAR(efforts[i], expected - s.force[i], 1e-8 * scale);
  }
}

/// W z = r: driven speeds keep their r, the free rows are those of the free part alone.
TEST_P(Motions, linearly_implicit_solutions_leave_driven_speeds_alone) {
  const Driven c(7, {.bodies = 6}, GetParam());
  const LinearlyImplicit* linear = c.equations->linearly_implicit();
  if (linear == nullptr) {
    EXPECT_TRUE(GetParam() == "inconsistent" || GetParam() == "consistent") << "strict forms alone offer none";
    return;
  }
  constexpr double delta = 0.01;
  Work factors = linear->make_factors();
  ASSERT_TRUE(linear->factorize(c.state.y, delta, factors).ok());
  const Layout& layout = c.equations->layout();
  std::vector<double> r(c.equations->size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = std::sin(1.0 + static_cast<double>(i));
  std::vector<double> z = r;
  linear->solve(z, factors);
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const DenseSystem s = c.equations->system(c.state.time, c.state.y);
  const Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>> M(s.mass.data(), n, n);
  // M (z_u − r_u) + (δD + δ²K) z_u + δ K r_q = 0 in the free rows.
  const Eigen::Map<const Eigen::VectorXd> zu(z.data() + layout.positions, n), ru(r.data() + layout.positions, n);
  Eigen::VectorXd residual = M * (zu - ru);
  Eigen::VectorXd scale = M.cwiseAbs() * (zu.cwiseAbs() + ru.cwiseAbs());
  for (const BodyNode& body : c.scene.model->bodies()) {
    const Slot* slot = layout.body(body.name);
    if (slot == nullptr) continue;
    const auto k = static_cast<Eigen::Index>(slot->speeds), at = static_cast<Eigen::Index>(slot->speed);
    const ModalShape& shape = body.body->shape();
    const Eigen::Map<const Eigen::VectorXd> rq(r.data() + slot->position, k);
    const Eigen::VectorXd elastic =
        (delta * shape.damping + delta * delta * shape.stiffness) * zu.segment(at, k) + delta * shape.stiffness * rq;
    residual.segment(at, k) += elastic;
    scale.segment(at, k) += elastic.cwiseAbs();
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (c.is_driven(static_cast<std::size_t>(i))) {
      EXPECT_EQ(zu[i], ru[i]);
    } else {
      EXPECT_NEAR(residual[i], 0, 1e-8 * scale[i]) << layout.speed_names[static_cast<std::size_t>(i)];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, Motions,
                         testing::Values("ruthless", "inconsistent", "consistent", "quadratic", "linear", "exact",
                                         "rate-linear", "symmetric", "symmetric-linear"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// Energy gained is the work of motions and loads, and driven coordinates end where their motions are, although they
/// are integrated as all others: to the accuracy asked for.
TEST(MotionsUntruncated, do_the_work_that_changes_the_energy_of_a_run) {
  for (const char* formulation : {"quadratic", "exact"}) {
    for (unsigned seed = 7; seed <= 9; ++seed) {
      const Driven c(seed, {.bodies = 5}, formulation);
      ASSERT_FALSE(c.scene.model->motions().empty());
      RunOptions options;
      options.end = 1.0;
      options.output = 0.05;
      options.deflection_limit = 10;
      const RunSummary run = simulate(*c.scene.model, *c.equations, *c.scene.integrator, c.state, options, {});
      EXPECT_EQ(run.status, RunStatus::completed) << run.message;
      EXPECT_LT(run.energy_drift, 1e-6) << formulation << ", seed " << seed;
      State moved = run.final;
      c.scene.model->prescribe(moved);
      for (std::size_t i = 0; i < moved.y.size(); ++i) EXPECT_NEAR(run.final.y[i], moved.y[i], 1e-8) << i;
    }
  }
}

}  // namespace
}  // namespace withy::test
