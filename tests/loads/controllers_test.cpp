// Feedback on hinges.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"
#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using std::numbers::pi;
using test::turntable;

// J ẍ = k (x_r − x) − c ẋ with J = 0.2, k = 5, c = 0.4: frequency 5 rad/s, damping ratio 0.2.
TEST(PdController, steps_as_the_second_order_system_it_makes) {
  test::LoadedScene s(turntable + R"(loads:
  control: {type: pd-controller, law: constant, hinges: {axle: {to: 0.5, stiffness: 5, damping: 0.4}}}
)");
  const double w = 5, zeta = 0.2, wd = w * std::sqrt(1 - zeta * zeta);
  for (const State& state : s.run()) {
    const double t = state.time;
    const double x = 0.5 * (1 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t)));
    EXPECT_NEAR(s.position(state, "axle"), x, 1e-9) << t;
  }
}

// The steady answer to x_r = A sin wt has the gain |G(iw)| = |(k + icw) / (k − Jw² + icw)|.
TEST(PdController, follows_a_sine_with_the_gain_of_its_transfer_function) {
  test::LoadedScene s(turntable + R"(loads:
  control:
    type: pd-controller
    law: sine
    period: 0.8
    hinges: {axle: {amplitude: 0.3, center: 0.1, stiffness: 5, damping: 1.2}}
)",
                      {"time.end=14", "time.output=0.005"});
  const double w = 2 * pi / 0.8;
  EXPECT_DOUBLE_EQ(s.position(s.scene.initial, "axle"), 0.1);
  EXPECT_DOUBLE_EQ(s.rate(s.scene.initial, "axle"), 0.3 * w);
  double peak = 0;
  for (const State& state : s.run()) {
    if (state.time > 12) peak = std::max(peak, std::abs(s.position(state, "axle") - 0.1));
  }
  const double gain = std::hypot(5, 1.2 * w) / std::hypot(5 - 0.2 * w * w, 1.2 * w);
  // The transient has died to exp(−3·12); the peak between samples is missed by less than (w · 2.5 ms)²/2 = 2e-4.
  EXPECT_NEAR(peak, 0.3 * gain, 3e-4 * gain * 0.3);
}

// A motion of a plugin is followed as the law of the same name is, at any time scale.
TEST(PdController, follows_motions_of_plugins_as_laws) {
  const auto along = [](const std::string& law, const std::string& of_hinge) {
    test::LoadedScene s(turntable + "loads:\n  control: {type: pd-controller, " + law +
                            ", time_scale: 2, hinges: {axle: {" + of_hinge + ", stiffness: 5, damping: 1.2}}}\n",
                        {"time.output=0.1"});
    std::vector<double> x;
    for (const State& state : s.run()) x.push_back(s.position(state, "axle"));
    return x;
  };
  // Twice as fast is exact, wherever time is scaled.
  EXPECT_EQ(along("law: motion", "motion: {type: quintic, from: 0.1, to: 0.7, duration: 2}"),
            along("law: quintic, duration: 2", "from: 0.1, to: 0.7"));
}

std::vector<double> efforts(const test::LoadedScene& s, const State& state) {
  std::vector<double> tau(s.scene.model->layout().speeds);
  const Layout& layout = s.scene.model->layout();
  for (const LoadNode& node : s.scene.model->loads()) {
    std::vector<double> scratch(node.load->scratch(), NAN);
    node.load->add(state.time, std::span(state.y).first(layout.positions),
                   std::span(state.y).subspan(layout.positions, layout.speeds), tau, scratch);
  }
  return tau;
}

TEST(PdController, never_exceeds_its_limit_and_is_the_plain_law_far_below_it) {
  const auto effort = [](double x) {
    const test::LoadedScene s(turntable + R"(loads:
  control: {type: pd-controller, law: constant, hinges: {axle: {stiffness: 100, damping: 0, limit: 2}}}
initial: {hinges: {axle: {position: [)" +
                              std::to_string(x) + "]}}}\n");
    return efforts(s, s.scene.initial)[0];
  };
  EXPECT_EQ(effort(-10), 2);
  EXPECT_EQ(effort(10), -2);
  EXPECT_NEAR(effort(0.0001), -0.01, 1e-7);  // tanh x = x − x³/3
  EXPECT_NEAR(effort(0.02), -2 * std::tanh(1), 1e-15);
}

TEST(PdController, controls_any_coordinate_of_a_hinge) {
  const test::LoadedScene s(R"(format: withy/1
bodies: {puck: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {glide: {type: planar, parent: world, child: puck}}
loads:
  x: {type: pd-controller, law: constant, hinges: {glide: {component: 1, to: 0.3, stiffness: 10, damping: 1}}}
  y: {type: pd-controller, law: constant, hinges: {glide: {component: 2, to: -0.1, stiffness: 20, damping: 1}}}
)");
  const std::vector<double> tau = efforts(s, s.scene.initial);
  EXPECT_EQ(tau[0], 0);
  EXPECT_DOUBLE_EQ(tau[1], 3);
  EXPECT_DOUBLE_EQ(tau[2], -2);
}

/// A heavy arm of three oblique joints, rigid.
const std::string robot = R"(format: withy/1
gravity: [1, -2, -9.81]
time: {output: 0.02}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies:
  a: {type: rigid, mass: 4, center_of_mass: [0.1, 0, 0.2], inertia: [0.2, 0.3, 0.15, 0.02, 0, 0.01], frames: {end: {position: [0.1, 0.1, 0.5]}}}
  b: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0.1], inertia: [0.1, 0.1, 0.1, 0, 0.01, 0], frames: {end: {position: [0.6, 0, 0]}}}
  c: {type: rigid, mass: 1, center_of_mass: [0.2, 0.1, 0], inertia: [0.05, 0.03, 0.04, 0, 0, 0]}
hinges:
  one: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  two: {type: revolute, axis: [0, 1, 0.3], parent: a.end, child: b}
  three: {type: prismatic, axis: [1, 0, 0.2], parent: b.end, child: c}
)";
const std::string targets = "{one: {from: 0, to: 90 deg}, two: {from: 0.2, to: -0.7}, three: {from: 0, to: 0.3}}";

// On a rigid tree the error obeys ë + 2ζωė + ω²e = 0 exactly; with ζ = 1 and e(0) = e₀, ė(0) = 0,
// e = e₀ (1 + ωt) exp(−ωt).
TEST(ComputedTorque, makes_the_error_of_a_rigid_tree_decay_as_asked) {
  test::LoadedScene s(robot + "loads: {control: {type: computed-torque, duration: 1.5, bandwidth: 4, hinges: " +
                      targets + "}}\ninitial: {hinges: {one: {position: [0.3]}, two: {position: [0.1]}}}\n");
  const double e0[] = {-0.3, 0.1, 0};
  const char* names[] = {"one", "two", "three"};
  const double from[] = {0, 0.2, 0}, change[] = {pi / 2, -0.9, 0.3};
  const std::vector<State> states = s.run();
  EXPECT_EQ(states.back().time, 1.5);
  for (const State& state : states) {
    const double r = state.time / 1.5, quintic = r * r * r * (10 - 15 * r + 6 * r * r);
    for (int i = 0; i < 3; ++i) {
      const double error = e0[i] * (1 + 4 * state.time) * std::exp(-4 * state.time);
      EXPECT_NEAR(s.position(state, names[i]), from[i] + change[i] * quintic - error, 1e-8) << state.time;
    }
  }
}

TEST(ComputedTorque, on_the_trajectory_its_efforts_are_those_of_the_open_loop) {
  const std::string law = "duration: 1.5, hinges: " + targets + "}}\n";
  test::LoadedScene open(robot + "loads: {slew: {type: rigid-inverse-dynamics, " + law);
  const test::LoadedScene closed(robot + "loads: {slew: {type: computed-torque, bandwidth: 3, " + law);
  for (const State& state : open.run()) {
    const std::vector<double> a = efforts(open, state), b = efforts(closed, state);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-5) << state.time;  // the run is off by about 1e-8
  }
}

// At rest friction hides an error of at most effort / stiffness = 0.1 / 30 rad = 0.2 degrees at the elbow, whose
// reaction at the shoulder is 0.1 / 150 rad. That the controller does the work shows where the gains are divided by a
// hundred: the same arm then is degrees away.
TEST(PdController, brings_a_flexible_arm_to_its_target_and_holds_it) {
  const auto errors = [](const std::vector<std::string>& overrides) {
    test::LoadedScene s(test::shipped("pd-arm.yaml"), overrides);
    const State end = s.run().back();
    return std::pair(std::abs(s.position(end, "shoulder") - pi / 3), std::abs(s.position(end, "elbow")));
  };
  const auto [shoulder, elbow] = errors({});
  EXPECT_LT(shoulder, 0.1 / 150);
  EXPECT_LT(elbow, 0.1 / 30);
  const std::string at = "loads.control.hinges.";
  const auto [slack_shoulder, slack_elbow] = errors({at + "shoulder.stiffness=1.5", at + "shoulder.damping=1.5",
                                                     at + "elbow.stiffness=0.3", at + "elbow.damping=0.25"});
  EXPECT_GT(slack_shoulder, 0.02);
  EXPECT_GT(slack_elbow, 0.02);
}

// Rigid trees follow the efforts of their inverse dynamics: each law ends where it should, to the integrator's accuracy
// times the growth of errors of an open loop under gravity.
TEST(RigidInverseDynamics, every_law_carries_a_rigid_tree_to_its_end) {
  for (const std::string law :
       {"law: quintic, duration: 1.2, hinges: {one: {to: 1}, two: {to: -0.7}, three: {to: 0.3}}",
        "law: bang-bang, duration: 1.2, hinges: {one: {to: 1}, two: {to: -0.7}, three: {to: 0.3}}",
        "law: table, hinges: {one: {table: [[0, 0], [0.5, 0.2], [1.2, 1]]}, two: {table: [[0, 0], "
        "[0.3, 0.1], [1.1, -0.7]]}, three: {table: [[0.2, 0], [1.2, 0.3]]}}"}) {
    test::LoadedScene s(robot + "loads: {slew: {type: rigid-inverse-dynamics, " + law + "}}\n");
    const State end = s.run().back();
    EXPECT_EQ(end.time, 1.2);
    EXPECT_NEAR(s.position(end, "one"), 1, 1e-7) << law;
    EXPECT_NEAR(s.position(end, "two"), -0.7, 1e-7) << law;
    EXPECT_NEAR(s.position(end, "three"), 0.3, 1e-7) << law;
    for (const char* hinge : {"one", "two", "three"}) EXPECT_NEAR(s.rate(end, hinge), 0, 1e-7) << law;
  }
}

TEST(RigidInverseDynamics, carries_a_rigid_tree_along_a_sine) {
  test::LoadedScene s(robot + R"(loads:
  slew:
    type: rigid-inverse-dynamics
    law: sine
    period: 1.6
    time_scale: 2
    hinges: {one: {amplitude: 0.5}, two: {amplitude: 0.2, phase: 1 rad}, three: {amplitude: 0.1, center: 0.3}}
)",
                      {"time.end=1"});
  const double w = 2 * pi / 0.8;
  for (const State& state : s.run()) {
    EXPECT_NEAR(s.position(state, "one"), 0.5 * std::sin(w * state.time), 1e-7);
    EXPECT_NEAR(s.position(state, "two"), 0.2 * std::sin(w * state.time + 1), 1e-7);
    EXPECT_NEAR(s.position(state, "three"), 0.3 + 0.1 * std::sin(w * state.time), 1e-7);
  }
}

// J ẍ = ±4 Δ J/T².
TEST(RigidInverseDynamics, bang_bang_takes_one_effort_and_its_opposite) {
  const test::LoadedScene s(turntable +
                            "loads: {slew: {type: rigid-inverse-dynamics, law: bang-bang, duration: 3, time_scale: 2, "
                            "hinges: {axle: {to: 0.9}}}}\n");
  State state = s.scene.initial;
  const double expected = 4 * 0.9 * 0.2 / (1.5 * 1.5);
  for (const auto& [t, sign] : {std::pair(0.0, 1), std::pair(0.74, 1), std::pair(0.75, -1), std::pair(1.49, -1),
                                std::pair(1.5, 0), std::pair(2.0, 0)}) {
    state.time = t;
    EXPECT_NEAR(efforts(s, state)[0], sign * expected, 1e-14) << t;
  }
  EXPECT_EQ(s.scene.model->loads()[0].load->discontinuities(), (std::vector<double>{0, 0.75, 1.5}));
}

// Near its limit, which it approaches smoothly, both gains count less.
TEST(PdController, differentiates_itself_near_its_limit) {
  Registry registry = load_registry();
  const auto servo = make_plugin<Load>(registry, "pd-controller",
                                       {{"law", Value(std::string("constant"))},
                                        {"hinges", Value::map({{"elbow", Value::map({{"to", Value(1.0)},
                                                                                     {"component", Value(0.0)},
                                                                                     {"stiffness", Value(3.0)},
                                                                                     {"damping", Value(2.0)},
                                                                                     {"limit", Value(4.0)}})}})}});
  test::expect_load_derivatives(*servo, two_link_arm(2));
}

TEST(Controllers, conform) {
  Registry registry = load_registry();
  const Model model = two_link_arm(2);
  const auto followed = [](std::vector<Value::Member> more) {
    more.emplace_back("component", Value(0.0));
    more.emplace_back("stiffness", Value(3.0));
    more.emplace_back("damping", Value(0.3));
    return Value::map({{"shoulder", Value::map(more)}, {"elbow", Value::map(std::move(more))}});
  };
  const Value rows = Value::list({list_of({0, 0}), list_of({0.4, 1}), list_of({1.3, -1})});
  const std::vector<std::vector<Value::Member>> laws = {
      {{"law", Value(std::string("quintic"))}, {"duration", Value(2.0)}, {"hinges", followed({{"to", Value(1.0)}})}},
      {{"law", Value(std::string("bang-bang"))}, {"duration", Value(2.0)}, {"hinges", followed({{"to", Value(1.0)}})}},
      {{"law", Value(std::string("sine"))}, {"period", Value(2.0)}, {"hinges", followed({{"amplitude", Value(1.0)}})}},
      {{"law", Value(std::string("table"))}, {"hinges", followed({{"table", rows}})}},
      {{"law", Value(std::string("constant"))}, {"hinges", followed({{"to", Value(1.0)}})}}};
  for (std::vector<Value::Member> given : laws) {
    given.emplace_back("bandwidth", Value(2.0));
    test::expect_load_conforms(*make_plugin<Load>(registry, "pd-controller", given), model);
    test::expect_load_conforms(*make_plugin<Load>(registry, "computed-torque", given), model);
    if (given[0].second.text() != "constant")
      test::expect_load_conforms(*make_plugin<Load>(registry, "rigid-inverse-dynamics", given), model);
  }
}

TEST(Controllers, what_a_law_lacks_or_does_not_take_is_said) {
  using testing::HasSubstr;
  const auto problem = [](const std::string& load) {
    return test::problem_of(turntable + "loads: {a: {" + load + "}}\n");
  };
  const std::string gains = "stiffness: 1, damping: 1";
  const std::string slew = "type: rigid-inverse-dynamics, ", pd = "type: pd-controller, ";
  EXPECT_THAT(problem(slew + "hinges: {axle: {to: 1}}"),
              HasSubstr("6:12: /loads/a: the law 'quintic' needs 'duration'"));
  EXPECT_THAT(problem(slew + "law: table, duration: 1, hinges: {axle: {table: [[0, 1]]}}"),
              HasSubstr("/loads/a/duration: the law 'table' takes no 'duration'"));
  EXPECT_THAT(problem(slew + "law: table, hinges: {axle: {to: 1}}"),
              HasSubstr("/loads/a/hinges/axle: the law 'table' needs 'table'"));
  EXPECT_THAT(problem(slew + "law: table, hinges: {axle: {to: 1}}"),
              HasSubstr("/loads/a/hinges/axle/to: the law 'table' takes no 'to'"));
  EXPECT_THAT(problem(slew + "duration: 1, hinges: {}"), HasSubstr("/loads/a/hinges: names no hinge"));
  EXPECT_THAT(problem(slew + "law: constant, hinges: {axle: {to: 1}}"), HasSubstr("need one of: quintic, bang-bang"));
  EXPECT_THAT(problem(pd + "law: constant, hinges: {axle: {from: 1, " + gains + "}}"),
              HasSubstr("/loads/a/hinges/axle/from: the law 'constant' takes no 'from'"));
  EXPECT_THAT(problem(pd + "law: sine, period: 1, hinges: {axle: {" + gains + "}}"),
              HasSubstr("/loads/a/hinges/axle: the law 'sine' needs 'amplitude'"));
  EXPECT_THAT(problem(pd + "law: sine, hinges: {axle: {amplitude: 1, " + gains + "}}"),
              HasSubstr("/loads/a: the law 'sine' needs 'period'"));
  EXPECT_THAT(problem(pd + "law: constant, hinges: {axle: {component: 3, " + gains + "}}"),
              HasSubstr("hinge 'axle' has 1 rates; there is no component 3"));
  EXPECT_THAT(problem("type: computed-torque, duration: 1, hinges: {axle: {to: 1}}"),
              HasSubstr("/loads/a/bandwidth: "));
}

TEST(Controllers, TellEachCommandInTheUnitOfItsPlace) {
  const test::Shown s(R"(format: withy/1
time: {end: 0.01}
bodies:
  cart: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  pole: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}
  a: {type: revolute, axis: [0, 0, 1], parent: cart, child: pole}
loads:
  ua: {type: input, hinge: a}
  ux: {type: input, hinge: x}
  uf: {type: input, frame: pole, direction: [1, 0, 0]}
  law: {type: state-space, of: [x], to: [ua, ux, uf], A: [[-1]], B: [[1]], C: [[1], [1], [1]], D: [[0], [0], [0]]}
outputs: {c: {type: control, of: law, show: command}}
)");
  std::map<std::string, std::string> units;
  for (const Column& column : s.columns) units[column.name] = column.unit;
  EXPECT_EQ(units,
            (std::map<std::string, std::string>{{"c.command.0", "N m"}, {"c.command.1", "N"}, {"c.command.2", "N"}}));
}

}  // namespace
}  // namespace withy
