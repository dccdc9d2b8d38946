// Springs, friction and stops of hinges.
#include <gmock/gmock.h>

#include <cmath>

#include "withy/core/plugin/kinks.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using test::turntable;

std::unique_ptr<Load> passive(const char* id, std::vector<Value::Member> given) {
  Registry registry = load_registry();
  given.emplace_back("hinge", Value(std::string("elbow")));
  return make_plugin<Load>(registry, id, std::move(given));
}

/// Effort on the elbow at a coordinate and rate of it, and nothing on any other speed.
double effort(const Load& load, double x, double rate) {
  const Model model = two_link_arm(2);
  const auto bound = load.bind(model);
  const Slot& slot = *model.layout().hinge("elbow");
  std::vector<double> positions(model.layout().positions, 7.0), speeds(model.layout().speeds, -5.0);
  std::vector<double> tau(speeds.size()), scratch(bound->scratch());
  positions[slot.position] = x;
  speeds[slot.speed] = rate;
  bound->add(0.3, positions, speeds, tau, scratch);
  const double elbow = std::exchange(tau[slot.speed], 0.0);
  EXPECT_EQ(tau, std::vector<double>(tau.size()));
  return elbow;
}

TEST(HingeSpring, is_linear_in_displacement_and_rate) {
  const auto spring = passive(
      "hinge-spring",
      {{"stiffness", Value(30.0)}, {"damping", Value(0.5)}, {"free_position", Value(0.2)}, {"preload", Value(-1.0)}});
  EXPECT_DOUBLE_EQ(effort(*spring, 0.5, 2.0), -1.0 - 30 * 0.3 - 0.5 * 2);
  EXPECT_DOUBLE_EQ(effort(*spring, 0.2, 0.0), -1.0);
}

TEST(HingeFriction, saturates_against_the_motion) {
  const auto friction = passive("hinge-friction", {{"effort", Value(3.0)}, {"rate_scale", Value(0.01)}});
  EXPECT_EQ(effort(*friction, 1, 0), 0);
  EXPECT_DOUBLE_EQ(effort(*friction, 1, 0.01), -3 * std::tanh(1));
  EXPECT_DOUBLE_EQ(effort(*friction, 1, 0.5), -3);
  EXPECT_DOUBLE_EQ(effort(*friction, 1, -0.5), 3);
}

const std::vector<Value::Member> stops = {{"lower", Value(-1.0)},
                                          {"upper", Value(0.5)},
                                          {"stiffness", Value(100.0)},
                                          {"dissipation", Value(0.4)},
                                          {"onset", Value(0.1)}};

// What a load at a hinge measures is what the hinge does.
TEST(HingeLoads, have_the_units_of_a_slide_at_a_slide) {
  const auto problem = [](const std::string& type, const std::string& more) {
    return test::problem_of(
        "format: withy/1\ntime: {end: 1}\nbodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {h: {type: " +
        type + ", axis: [0, 0, 1], parent: world, child: a}}\n" + more);
  };
  const auto load = [](const std::string& text) { return "loads: {x: {hinge: h, " + text + "}}\n"; };
  const auto motion = [](const std::string& text) { return "motions: {x: {hinge: h, " + text + "}}\n"; };
  const std::vector<std::pair<std::string, std::string>> turning_and_sliding = {
      {load("type: hinge-spring, stiffness: 5 N m/rad, damping: 1 N m s/rad, free_position: 30 deg, preload: 1 N m"),
       load("type: hinge-spring, stiffness: 5 N/mm, damping: 1 N s/m, free_position: 30 mm, preload: 1 N")},
      {load("type: hinge-effort, value: 1 N m"), load("type: hinge-effort, value: 1 kN")},
      {load("type: hinge-effort, law: table, table: [[0, 1 N m], [1, 0]]"),
       load("type: hinge-effort, law: table, table: [[0, 1 N], [1, 0]]")},
      {load("type: hinge-limit, upper: 30 deg, stiffness: 10, onset: 1 deg"),
       load("type: hinge-limit, upper: 30 mm, stiffness: 10, onset: 1 mm")},
      {load("type: hinge-friction, effort: 1 N m, rate_scale: 1 deg/s"),
       load("type: hinge-friction, effort: 1 N, rate_scale: 1 mm/s")},
      {motion("type: sine, amplitude: 30 deg, period: 1, phase: 90 deg"),
       motion("type: sine, amplitude: 30 mm, period: 1, phase: 90 deg")},
      {motion("type: table, table: [[0, 0], [1, 30 deg]]"), motion("type: table, table: [[0, 0], [1, 30 mm]]")},
      {"loads: {x: {type: pd-controller, law: constant, hinges: {h: {to: 30 deg, stiffness: 1, damping: 1, limit: 1 N "
       "m}}}}\n",
       "loads: {x: {type: pd-controller, law: constant, hinges: {h: {to: 30 mm, stiffness: 1, damping: 1, limit: 1 "
       "N}}}}\n"},
      {"loads: {x: {type: pd-controller, law: motion, hinges: {h: {motion: {type: quintic, to: 30 deg, duration: 1}, "
       "stiffness: 1, damping: 1}}}}\n",
       "loads: {x: {type: pd-controller, law: motion, hinges: {h: {motion: {type: quintic, to: 30 mm, duration: 1}, "
       "stiffness: 1, damping: 1}}}}\n"},
      {"events: {e: {hinge: h, value: 30 deg}}\n", "events: {e: {hinge: h, value: 30 mm}}\n"},
      {"events: {e: {hinge: h, of: rate, value: 30 deg/s}}\n", "events: {e: {hinge: h, of: rate, value: 30 mm/s}}\n"}};
  for (const auto& [turning, sliding] : turning_and_sliding) {
    EXPECT_EQ(problem("revolute", turning), "") << turning;
    EXPECT_EQ(problem("prismatic", sliding), "") << sliding;
    EXPECT_THAT(problem("prismatic", turning), testing::HasSubstr("is a wrong unit here; need ")) << turning;
    EXPECT_THAT(problem("revolute", sliding), testing::HasSubstr("is a wrong unit here; need ")) << sliding;
  }
}

TEST(HingeLimit, pushes_back_from_beyond_either_stop_and_never_pulls) {
  const auto limit = passive("hinge-limit", stops);
  for (const double x : {-1.0, -0.3, 0.5}) EXPECT_EQ(effort(*limit, x, 3.0), 0) << x;
  EXPECT_NEAR(effort(*limit, 0.55, 0), -100 * 0.05 * 0.05 / 0.2, 1e-12);
  EXPECT_NEAR(effort(*limit, 0.8, 0), -100 * (0.3 - 0.05), 1e-12);
  EXPECT_NEAR(effort(*limit, 0.8, 2), -100 * (0.3 - 0.05) * 1.8, 1e-12);  // inward: more
  EXPECT_NEAR(effort(*limit, 0.8, -2), -100 * (0.3 - 0.05) * 0.2, 1e-12);
  EXPECT_EQ(effort(*limit, 0.8, -3), 0);
  EXPECT_NEAR(effort(*limit, -1.3, -2), 100 * (0.3 - 0.05) * 1.8, 1e-12);
  EXPECT_EQ(effort(*limit, -1.3, 3), 0);
}

// Slopes to the left and right of the points where the formula changes.
TEST(HingeLimit, has_no_kink_in_the_coordinate) {
  const auto limit = passive("hinge-limit", stops);
  const double h = 1e-7;
  for (const double x : {0.5, 0.6, -1.0, -1.1}) {
    const double left = (effort(*limit, x, 0.5) - effort(*limit, x - h, 0.5)) / h;
    const double right = (effort(*limit, x + h, 0.5) - effort(*limit, x, 0.5)) / h;
    EXPECT_NEAR(left, right, 1e-3) << x;  // the slope changes by k/w · h = 1e-4 over h
  }
}

TEST(HingeLimit, tells_how_far_the_nearest_stop_is) {
  const Model model = two_link_arm(2);
  const auto bound = passive("hinge-limit", stops)->bind(model);
  const std::size_t elbow = model.layout().hinge("elbow")->position;
  std::vector<double> positions(model.layout().positions, 7.0), margin(1);
  for (const auto& [x, left] : {std::pair(-0.9, 0.1), {0.25, 0.25}, {-1.5, -0.5}, {0.75, -0.25}}) {
    positions[elbow] = x;
    dynamic_cast<const Kinks&>(*bound).kinks(positions, {}, margin);
    EXPECT_NEAR(margin[0], left, 1e-15) << x;
  }
}

TEST(PassiveLoads, conform) {
  const Model model = two_link_arm(2);
  test::expect_load_conforms(*passive("hinge-spring", {{"stiffness", Value(30.0)}, {"free_position", Value(0.2)}}),
                             model);
  test::expect_load_conforms(*passive("hinge-friction", {{"effort", Value(3.0)}, {"rate_scale", Value(0.01)}}), model);
  test::expect_load_conforms(*passive("hinge-limit", {{"lower", Value(0.5)}, {"stiffness", Value(10.0)}}), model);
}

// The suite's states are within 0.3 of zero: beyond these stops.
TEST(PassiveLoads, differentiate_themselves_at_either_stop_and_in_slow_friction) {
  const Model model = two_link_arm(2);
  for (const auto& [lower, upper] : {std::pair(1.0, 2.0), {-2.0, -1.0}})
    test::expect_load_derivatives(*passive("hinge-limit", {{"lower", Value(lower)},
                                                           {"upper", Value(upper)},
                                                           {"stiffness", Value(10.0)},
                                                           {"dissipation", Value(0.8)}}),
                                  model);
  test::expect_load_derivatives(*passive("hinge-friction", {{"effort", Value(3.0)}, {"rate_scale", Value(0.4)}}),
                                model);
}

// J ẍ + c ẋ + k (x − x₀) = p, J = 0.2: with k = 5, c = 0.4 the frequency is 5 rad/s, the damping ratio 0.2.
TEST(HingeSpring, swings_as_the_damped_oscillator_it_is) {
  test::LoadedScene s(turntable + R"(loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 5, damping: 0.4, free_position: 0.3, preload: 1}
)");
  const double w = 5, zeta = 0.2, wd = w * std::sqrt(1 - zeta * zeta), rest = 0.3 + 1.0 / 5;
  for (const State& state : s.run()) {
    const double t = state.time;
    const double x = rest - rest * std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
    EXPECT_NEAR(s.position(state, "axle"), x, 1e-9) << t;  // tolerance of the integrator over 20 steps
  }
}

// Sliding under Coulomb friction: the table stops after J v / c = 0.5 s, having turned v²J/(2c). While ẋ > s the tanh
// is short of one by at most 2 exp(−2ẋ/s): the error is of the order of s times the time, 1e-4.
TEST(HingeFriction, stops_a_table_as_dry_friction_does) {
  test::LoadedScene s(turntable + R"(loads:
  friction: {type: hinge-friction, hinge: axle, effort: 0.8, rate_scale: 1e-4}
initial: {hinges: {axle: {rate: [2]}}}
)");
  const State end = s.run().back();
  EXPECT_NEAR(s.position(end, "axle"), 0.2 * 4 / (2 * 0.8), 1e-4);
  EXPECT_NEAR(s.rate(end, "axle"), 0, 1e-6);
  EXPECT_LT(s.summary.energy_drift, 1e-8);
}

// Hunt & Crossley (1975): for slow impacts the coefficient of restitution is 1 − ⅔ α v, whatever the elastic law.
TEST(HingeLimit, restores_what_its_dissipation_says) {
  for (const double v : {0.02, 0.05}) {
    std::string scene = turntable + R"(loads:
  stop: {type: hinge-limit, hinge: axle, upper: 0.01, stiffness: 500, dissipation: 1.5, onset: 0.02}
initial: {hinges: {axle: {rate: [)" +
                        std::to_string(v) + "]}}}\n";
    test::LoadedScene s(scene);
    const State end = s.run().back();
    EXPECT_LT(s.position(end, "axle"), 0.01);  // it has come back
    const double alpha = 1.5;
    EXPECT_NEAR(-s.rate(end, "axle") / v, 1 - 2.0 / 3 * alpha * v, (alpha * v) * (alpha * v));
  }
}

// A heavy pendulum with a spring and no losses: the work of the spring is the potential energy it loses, so that energy
// less work is conserved, and with ½ k (x − x₀)² the sum is.
TEST(HingeSpring, its_work_closes_the_balance_of_energy) {
  test::LoadedScene s(R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 3, output: 0.05}
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies:
  arm: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 20, modes: 2}}
hinges: {pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads:
  spring: {type: hinge-spring, hinge: pivot, stiffness: 3, free_position: 0.4}
initial: {hinges: {pivot: {rate: [1]}}}
)");
  const auto total = [&](const State& state) {
    const Energies e = s.equations->energies(state.y);
    const double x = s.position(state, "pivot") - 0.4;
    return e.kinetic + e.potential + 0.5 * 3 * x * x;
  };
  const std::vector<State> states = s.run();
  double lost = 0;
  for (const State& state : states) {
    EXPECT_NEAR(total(state), total(states.front()), 1e-7);  // outputs are interpolated, to less than the tolerance
    const double x = s.position(state, "pivot") - 0.4;
    EXPECT_NEAR(state.y.back(), 0.5 * 3 * (0.4 * 0.4 - x * x), 1e-7);
    lost = std::max(lost, std::abs(state.y.back()));
  }
  EXPECT_GT(lost, 0.2);  // J, so that 1e-7 means something
  EXPECT_LT(s.summary.energy_drift, 1e-9);
}

TEST(PassiveLoads, act_on_the_lengths_of_hinges_with_quaternions) {
  test::LoadedScene s(R"(format: withy/1
time: {end: 1, output: 0.1}
bodies: {cube: {type: rigid, mass: 2, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {float: {type: free, parent: world, child: cube}}
loads:
  spring: {type: hinge-spring, hinge: float, component: 4, stiffness: 3, free_position: 0.5}
  drag: {type: hinge-spring, hinge: float, component: 1, damping: 0.2}
initial: {hinges: {float: {rate: [0, 1, 0, 0, 0, 0]}}}
)");
  std::vector<double> y_dot(s.equations->size());
  Work work = s.equations->make_work();
  ASSERT_TRUE(s.equations->derivatives(0, s.scene.initial.y, y_dot, work).ok());
  EXPECT_NEAR(y_dot[7 + 4], 3 * 0.5 / 2, 1e-14);
  EXPECT_NEAR(y_dot[7 + 1], -0.2 / 0.1, 1e-14);
}

TEST(PassiveLoads, what_they_cannot_do_is_said) {
  using testing::HasSubstr;
  const auto problem = [](const std::string& loads) {
    return test::problem_of(turntable + "loads: {a: {" + loads + "}}\n");
  };
  EXPECT_THAT(problem("type: hinge-spring, hinge: axle"),
              HasSubstr("6:12: /loads/a: does nothing; need 'stiffness', 'damping' or 'preload'"));
  EXPECT_THAT(problem("type: hinge-limit, hinge: axle, stiffness: 2"),
              HasSubstr("6:12: /loads/a: has no stop; need 'lower', 'upper' or both"));
  EXPECT_THAT(problem("type: hinge-limit, hinge: axle, stiffness: 2, lower: 1, upper: 1"),
              HasSubstr("/loads/a/upper: 'upper' is not above 'lower'"));
  EXPECT_THAT(problem("type: hinge-friction, hinge: axle, component: 1, effort: 2, rate_scale: 1"),
              HasSubstr("there is no component 1"));
  const std::string ball = R"(format: withy/1
bodies: {b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {ball: {type: spherical, parent: world, child: b}}
loads: {a: {type: hinge-spring, hinge: ball, component: 2, stiffness: 1}}
)";
  EXPECT_THAT(test::problem_of(ball), HasSubstr("rate 2 of hinge 'ball' is the derivative of no coordinate; need an "
                                                "angle or a displacement"));
}

// Free fall tells an implicit integrator nothing of a stop that is met at the end of a step.
TEST(HingeLimit, is_met_by_implicit_steps_as_by_explicit_ones) {
  const auto fall = [](const std::string& integrator) {
    test::LoadedScene c(
        "format: withy/1\ntime: {end: 1.5, output: 0.05}\ngravity: [0, 0, -9.81]\nintegrator: " + integrator +
        R"(
bodies: {ball: {type: rigid, mass: 1}}
hinges: {h: {type: prismatic, axis: [0, 0, 1], parent: world, child: ball}}
loads: {stop: {type: hinge-limit, hinge: h, lower: 0, stiffness: 2e5, dissipation: 0.1}}
initial: {hinges: {h: {position: [1]}}}
)");
    std::vector<double> heights;
    for (const State& s : c.run()) heights.push_back(c.position(s, "h"));
    return heights;
  };
  const std::vector<double> reference = fall("{name: dopri5, rtol: 1e-10, atol: 1e-12}"), stiff = fall("{name: radau}");
  ASSERT_EQ(stiff.size(), reference.size());
  for (std::size_t i = 0; i < stiff.size(); ++i)
    EXPECT_NEAR(stiff[i], reference[i], 1e-3) << 0.05 * static_cast<double>(i);
}

}  // namespace
}  // namespace withy
