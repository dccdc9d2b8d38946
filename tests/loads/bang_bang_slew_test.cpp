// Slews of least time under limited efforts.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using std::numbers::pi;

Value axis(double from, double to, double limit) {
  return Value::map({{"from", Value(from)}, {"to", Value(to)}, {"limit", Value(limit)}});
}

/// The slew of the paper's arm, shoulder 0 → 60°, elbow 135° → 0°.
std::unique_ptr<Load> arm_slew(double shoulder, double elbow) {
  Registry registry = load_registry();
  return make_plugin<Load>(
      registry, "bang-bang-slew",
      {{"hinges", Value::map({{"shoulder", axis(0, pi / 3, shoulder)}, {"elbow", axis(0.75 * pi, 0, elbow)}})}});
}

// Turning by Δ with an inertia J and |τ| ≤ L takes 2 √(Δ J / L), half of it speeding up.
TEST(BangBangSlew, of_one_hinge_is_the_textbook_one) {
  const test::LoadedScene s(R"(format: withy/1
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {slew: {type: bang-bang-slew, hinges: {axle: {from: 0.4, to: -0.5, limit: 2}}}}
)");
  const BoundLoad& load = *s.scene.model->loads()[0].load;
  const double end = 2 * std::sqrt(0.9 * 0.2 / 2);
  EXPECT_NEAR(load.end(), end, 1e-9);
  ASSERT_EQ(load.discontinuities().size(), 3u);
  EXPECT_NEAR(load.discontinuities()[1], end / 2, 1e-9);
  std::vector<double> tau(1);
  load.add(0.1, {}, {}, tau, {});
  EXPECT_EQ(tau[0], -2);
  // From each instant on: steps that begin there are of what follows.
  for (const auto& [t, effort] : {std::pair(load.discontinuities()[1], 2.0), {load.end(), 0.0}}) {
    tau[0] = 0;
    load.add(t, {}, {}, tau, {});
    EXPECT_EQ(tau[0], effort) << t;
  }
}

// A pendulum that a run begins with before 0 is held where the slew begins, and afterwards where it ends: m g l sin x.
TEST(BangBangSlew, carries_the_weight_before_and_after) {
  const test::LoadedScene s(R"(format: withy/1
gravity: [0, -9.81, 0]
bodies: {rod: {type: rigid, mass: 2, center_of_mass: [0, -0.5, 0], inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}
loads: {slew: {type: bang-bang-slew, hinges: {pivot: {from: 0.3, to: -0.4, limit: 20}}}}
)");
  const BoundLoad& load = *s.scene.model->loads()[0].load;
  for (const auto& [t, angle] : {std::pair(-1.0, 0.3), {-1e-9, 0.3}, {load.end(), -0.4}}) {
    std::vector<double> tau(1);
    load.add(t, {}, {}, tau, {});
    EXPECT_NEAR(tau[0], 2 * 9.81 * 0.5 * std::sin(angle), 1e-12) << t;
  }
}

// The same search on the closed-form equations of the rigid arm, with steps fine enough for the digits given. Limits of
// 10 and 10 N m have two extremals, which end at 2.65697 and 2.35211 s: the faster counts.
TEST(BangBangSlew, of_the_papers_arm_has_the_switches_of_its_closed_form) {
  const Model model = two_link_arm(0);
  const auto slew = arm_slew(10, 2.5)->bind(model);
  EXPECT_NEAR(slew->end(), 2.53131, 1e-4);
  const double expected[] = {0, 0.1997, 1.2657, 1.7510, 2.53131};
  const std::vector<double> jumps = slew->discontinuities();
  ASSERT_EQ(jumps.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(jumps[i], expected[i], 2e-4);
  EXPECT_NEAR(arm_slew(10, 10)->bind(model)->end(), 2.35211, 1e-4);
}

// Scaling of time: efforts L/4 take twice as long.
TEST(BangBangSlew, takes_twice_the_time_with_a_quarter_of_the_effort) {
  const Model model = two_link_arm(2);  // its bodies count as rigid
  const auto fast = arm_slew(10, 2.5)->bind(model), slow = arm_slew(2.5, 0.625)->bind(model);
  EXPECT_NEAR(slow->end(), 2 * fast->end(), 1e-7);
}

// No other motion under the same limits is faster; the quintic and the rest-to-rest bang-bang in each angle are at
// hand.
TEST(BangBangSlew, is_faster_than_other_slews_under_the_same_limits) {
  const Model model = two_link_arm(0);
  const double limits[] = {10, 2.5};
  const double least = arm_slew(limits[0], limits[1])->bind(model)->end();
  Registry registry = load_registry();
  for (const char* law : {"quintic", "bang-bang"}) {
    const auto target = [](double from, double to) { return Value::map({{"from", Value(from)}, {"to", Value(to)}}); };
    const auto slew =
        make_plugin<Load>(registry, "rigid-inverse-dynamics",
                          {{"law", Value(std::string(law))},
                           {"duration", Value(1.0)},
                           {"hinges", Value::map({{"shoulder", target(0, pi / 3)}, {"elbow", target(0.75 * pi, 0)}})}})
            ->bind(model);
    double need = 0;  // peak effort over limit, at a duration of 1 s: it falls with the square of the duration
    for (int i = 0; i <= 1000; ++i) {
      std::vector<double> tau(2), scratch(slew->scratch());
      const std::vector<double> y(4);
      slew->add(i / 1000.0, std::span(y).first(2), std::span(y).subspan(2), tau, scratch);
      for (std::size_t k = 0; k < 2; ++k) need = std::max(need, std::abs(tau[k]) / limits[k]);
    }
    EXPECT_LT(least, 0.95 * std::sqrt(need)) << law;
  }
}

// Heavy, in space, with a slide: the run of the rigid tree itself arrives, at rest.
TEST(BangBangSlew, carries_a_heavy_rigid_tree_to_its_target) {
  test::LoadedScene s(R"(format: withy/1
gravity: [0, -1, -9.81]
time: {output: 0.1}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies:
  column: {type: rigid, mass: 4, inertia: [0.2, 0.2, 0.2, 0, 0, 0], frames: {side: {position: [0.1, 0, 0.3]}}}
  arm: {type: rigid, mass: 2, center_of_mass: [0.4, 0.1, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  turn: {type: revolute, axis: [0, 0, 1], parent: world, child: column}
  reach: {type: prismatic, axis: [1, 0, 0.2], parent: column.side, child: arm}
loads: {slew: {type: bang-bang-slew, hinges: {turn: {to: 1.2, limit: 6}, reach: {to: 0.4, limit: 15}}}}
)");
  const State end = s.run().back();
  EXPECT_EQ(end.time, s.scene.model->loads()[0].load->end());
  EXPECT_NEAR(s.position(end, "turn"), 1.2, 1e-6);
  EXPECT_NEAR(s.position(end, "reach"), 0.4, 1e-6);
  EXPECT_NEAR(s.rate(end, "turn"), 0, 1e-6);
  EXPECT_NEAR(s.rate(end, "reach"), 0, 1e-6);
  EXPECT_LE(s.summary.peak_effort[0], 6);
  EXPECT_LE(s.summary.peak_effort[1], 15);
}

/// The shipped slew with links that are rigid.
std::vector<std::string> rigid(std::vector<std::string> more) {
  for (const char* o : {"bodies.link1.bending_y.modes=0", "bodies.link2.bending_y.modes=0", "integrator.rtol=1e-10",
                        "integrator.atol=1e-12"})
    more.emplace_back(o);
  return more;
}

TEST(BangBangSlew, carries_the_rigid_arm_to_its_target_with_three_switches_or_four) {
  const std::string at = "loads.slew.hinges.";
  const std::vector<std::string> across = {at + "shoulder.from=70 deg", at + "shoulder.to=51 deg",
                                           at + "elbow.from=118 deg",   at + "elbow.to=-48 deg",
                                           at + "shoulder.limit=36",    at + "elbow.limit=9"};
  struct Slew {
    std::vector<std::string> overrides;
    std::size_t switches;
    double shoulder, elbow;  // degrees
  };
  for (const Slew& slew : {Slew{{}, 3, 60, 0}, Slew{across, 4, 51, -48}}) {
    test::LoadedScene s(test::shipped("least-time-slew.yaml"), rigid(slew.overrides));
    EXPECT_EQ(s.scene.model->loads()[0].load->discontinuities().size(), slew.switches + 2);
    const State end = s.run().back();
    EXPECT_NEAR(s.position(end, "shoulder"), slew.shoulder * pi / 180, 1e-6);
    EXPECT_NEAR(s.position(end, "elbow"), slew.elbow * pi / 180, 1e-6);
    EXPECT_NEAR(s.rate(end, "shoulder"), 0, 1e-6);
    EXPECT_NEAR(s.rate(end, "elbow"), 0, 1e-6);
  }
}

// It is for the rigid tree: scenes that differ in their modes share a plan, to the last bit, and no other scene does.
TEST(BangBangSlew, is_the_same_whatever_modes_the_tree_has_and_another_where_the_tree_is) {
  const auto switches = [](const std::vector<std::string>& overrides) {
    return test::LoadedScene(test::shipped("least-time-slew.yaml"), overrides)
        .scene.model->loads()[0]
        .load->discontinuities();
  };
  const std::vector<double> usual = switches({});
  EXPECT_EQ(switches({"bodies.link1.bending_y.modes=4", "bodies.link2.bending_y.modes=1"}), usual);
  EXPECT_NE(switches({"bodies.payload.mass=2.001"}), usual);
  EXPECT_NE(switches({"loads.slew.hinges.elbow.to=1 deg"}), usual);
  EXPECT_EQ(switches({}), usual) << "nor does it matter what was made between";
}

// Two slides that do not feel each other: the slower, 2 √(0.9 · 3 / 2) s, decides, and the other spends what it has
// left.
TEST(BangBangSlew, of_independent_axes_takes_the_time_of_the_slower) {
  test::LoadedScene s(R"(format: withy/1
time: {output: 0.1}
bodies: {bridge: {type: rigid, mass: 2}, crab: {type: rigid, mass: 1}}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: bridge}
  y: {type: prismatic, axis: [0, 1, 0], parent: bridge, child: crab}
loads: {slew: {type: bang-bang-slew, hinges: {x: {to: 0.9, limit: 2}, y: {to: -0.2, limit: 1}}}}
)");
  const State end = s.run().back();
  EXPECT_NEAR(end.time, 2 * std::sqrt(0.9 * 3 / 2), 1e-8);
  EXPECT_NEAR(s.position(end, "x"), 0.9, 1e-6);
  EXPECT_NEAR(s.position(end, "y"), -0.2, 1e-6);
  EXPECT_NEAR(s.rate(end, "y"), 0, 1e-6);
}

TEST(BangBangSlew, conforms) { test::expect_load_conforms(*arm_slew(10, 2.5), two_link_arm(2)); }

TEST(BangBangSlew, what_it_cannot_do_is_said) {
  using testing::HasSubstr;
  const auto problem = [](const std::string& hinges) {
    return test::problem_of(R"(format: withy/1
gravity: [0, -9.81, 0]
bodies: {rod: {type: rigid, mass: 1, center_of_mass: [1, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}
loads: {slew: {type: bang-bang-slew, hinges: )" +
                            hinges + "}}\n");
  };
  EXPECT_THAT(problem("{}"), HasSubstr("5:46: /loads/slew/hinges: got 0 hinges; need one or two to move"));
  EXPECT_THAT(problem("{axle: {from: 1, to: 1, limit: 2}}"), HasSubstr("moves nothing"));
  EXPECT_THAT(problem("{axle: {to: 1}}"), HasSubstr("/loads/slew/hinges/axle/limit: "));
  // The weight alone needs 9.81 N m.
  EXPECT_THAT(problem("{axle: {to: 1, limit: 5}}"), HasSubstr("/loads/slew: found no bang-bang efforts of least time"));
}

}  // namespace
}  // namespace withy
