/// \file
/// Wrenches at frames: the sweeps' recursion against explicit Jacobians, virtual power and energy, on random trees.
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

/// A tree of bodies b0, b1, …, each with frames `a` and `m`, under one load of every kind at frames.
std::string loaded(unsigned seed, const SceneWish& wish) {
  std::mt19937 random(seed + 1000);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const auto frame = [&](int body) {
    return "b" + std::to_string(body) + (std::uniform_int_distribution<int>(0, 1)(random) == 0 ? ".a" : ".m");
  };
  const int last = wish.bodies - 1;
  std::ostringstream text;
  text << RandomScene(seed, wish).text() << "integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}\nloads:\n";
  const auto vector = [&] {
    std::ostringstream v;
    v << "[" << number() << ", " << number() << ", " << (wish.planar ? 0.0 : number()) << "]";
    return v.str();
  };
  const auto moment = [&] { return wish.planar ? "[0, 0, " + std::to_string(number()) + "]" : vector(); };
  text << "  dead: {type: force, frame: " << frame(last) << ", law: constant, value: " << vector() << "}\n"
       << "  follower: {type: force, frame: " << frame(last / 2)
       << ", following: true, law: sine, amplitude: " << vector() << ", period: 0.7, phase: 0.4}\n"
       << "  twist: {type: torque, frame: " << frame(last) << ", law: constant, value: " << moment() << "}\n"
       << "  turning: {type: torque, frame: b0.a, following: true, law: constant, value: " << moment() << "}\n"
       << "  rod: {type: spring-damper, frame: " << frame(last) << ", to: b0.m"
       << ", stiffness: 30, damping: 2, free_length: 0.3}\n"
       << "  rope: {type: spring-damper, frame: " << frame(last) << ", anchor: " << vector()
       << ", stiffness: 20, free_length: 0.1}\n"
       << "  jet: {type: thruster, frame: " << frame(last / 3) << ", thrust: 2, direction: " << vector()
       << ", firings: [[-1, 0.2], [0.5, 0.9]]}\n";
  return text.str();
}

struct Loaded {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  State state;

  Loaded(unsigned seed, const SceneWish& wish, const std::string& formulation) {
    enroll_static_plugins(registry);
    scene = parse_scene(loaded(seed, wish), "random", registry, {formulation, "", {}});
    equations = scene.formulation->compile(scene.model);
    state = RandomScene(seed, wish).state(*scene.model, scene.initial);
    state.time = 0.1;
  }
  [[nodiscard]] std::vector<double> efforts(int load = EquationsOfMotion::all_loads) const {
    std::vector<double> e(equations->layout().speeds, 7.0);
    Work work = equations->make_work();
    work.poison();
    const std::size_t before = allocations();
    equations->load_efforts(state.time, state.y, load, e, work);
    EXPECT_EQ(allocations(), before);
    return e;
  }
};

double largest(const std::vector<double>& v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

class FrameLoads : public testing::TestWithParam<std::string> {};

/// J_ωᵀ m + J_vᵀ f with the reference's Jacobians of every speed; strict: its dual numbers. In space the sweep and the
/// reference turn the sections of a rod by different methods, which differ by less than 1e-8 here.
TEST_P(FrameLoads, efforts_are_those_of_explicit_jacobians) {
  const double tolerance = GetParam() == "exact" ? 1e-8 : 1e-12;
  int compared = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const SceneWish wish{.bodies = 2 + static_cast<int>(seed % 6),
                         .planar = seed % 3 == 0,
                         .any_root = seed % 2 == 0,
                         .any_family = seed % 4 >= 2};
    const Loaded made(seed, wish, GetParam());
    const std::vector<double> mine = made.efforts();
    const std::vector<double> reference = made.equations->system(made.state.time, made.state.y).applied;
    for (std::size_t i = 0; i < mine.size(); ++i)
      EXPECT_NEAR(mine[i], reference[i], tolerance * (1 + largest(reference))) << "seed " << seed << ", row " << i;
    ++compared;
  }
  EXPECT_GE(compared, 30);
}

TEST_P(FrameLoads, efforts_of_single_loads_add_up) {
  const Loaded c(5, {.bodies = 5}, GetParam());
  std::vector<double> sum(c.equations->layout().speeds);
  for (std::size_t l = 0; l < c.scene.model->loads().size(); ++l) {
    const std::vector<double> e = c.efforts(static_cast<int>(l));
    EXPECT_GT(largest(e), 0) << c.scene.model->loads()[l].name;
    for (std::size_t i = 0; i < e.size(); ++i) sum[i] += e[i];
  }
  const std::vector<double> all = c.efforts();
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(sum[i], all[i], 1e-13 * (1 + largest(all)));
}

INSTANTIATE_TEST_SUITE_P(Formulations, FrameLoads,
                         testing::Values("ruthless", "inconsistent", "consistent", "quadratic", "linear", "exact",
                                         "rate-linear", "symmetric", "symmetric-linear"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// Where nothing is truncated the efforts' power is force · velocity, the velocity being that of the frame's position
/// as outputs show it. Central differences over 1e-5 s leave 1e-10 of the third derivative.
TEST(FrameLoadsUntruncated, power_of_a_dead_force_is_that_on_the_path_of_its_frame) {
  for (const char* formulation : {"quadratic", "linear", "exact"}) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
      const Loaded c(seed, {.bodies = 2 + static_cast<int>(seed % 5), .any_root = seed % 2 == 0}, formulation);
      const Model& model = *c.scene.model;
      const FrameIndex at = model.loads()[0].load->frames()[0];
      ASSERT_EQ(model.loads()[0].name, "dead");
      Work work = c.equations->make_work();
      std::vector<double> y_dot(c.equations->size());
      ASSERT_TRUE(c.equations->derivatives(c.state.time, c.state.y, y_dot, work).ok());
      constexpr double h = 1e-5;
      const auto position = [&](double dt) {
        std::vector<double> y = c.state.y;
        for (std::size_t i = 0; i < model.layout().positions; ++i) y[i] += dt * y_dot[i];
        c.equations->normalize(y);
        return Vector3(c.equations->frame_pose(y, at.body, at.frame).position.data());
      };
      const Vector3 velocity = (position(h) - position(-h)) / (2 * h);
      std::vector<Wrench> wrench(1);
      model.loads()[0].load->wrenches(c.state.time, std::vector<FrameMotion>(1), wrench);
      const std::vector<double> efforts = c.efforts(0);
      double power = 0;
      for (std::size_t i = 0; i < efforts.size(); ++i) power += efforts[i] * c.state.y[model.layout().positions + i];
      EXPECT_NEAR(power, wrench[0].force.dot(velocity), 1e-8 * (1 + std::abs(power))) << formulation << ", " << seed;
    }
  }
}

/// The loads' work is the change of energy, whatever they do. 1e-8 is the integrator's tolerance with a margin of 10.
TEST(FrameLoadsUntruncated, work_of_all_loads_balances_the_energy_of_a_run) {
  for (const char* formulation : {"quadratic", "exact"}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Loaded c(seed, {.bodies = 4}, formulation);
      RunOptions options;
      options.end = 0.6;
      options.output = 0.05;
      options.deflection_limit = 10;
      const RunSummary run = simulate(*c.scene.model, *c.equations, *c.scene.integrator, c.state, options, {});
      EXPECT_EQ(run.status, RunStatus::completed) << run.message;
      EXPECT_LT(run.energy_drift, 1e-5) << formulation << ", seed " << seed;
      EXPECT_GT(std::abs(run.final.y.back()), 0.01);
    }
  }
}

}  // namespace
}  // namespace withy::test
