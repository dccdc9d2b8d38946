/// \file
/// Events that lock hinges and let bodies go: impulses, what they take, what stays.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "acted_run.hpp"
#include "withy/core/simulation/event_actions.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {
namespace {

using test::ActedRun;
using test::deployment;
using test::discs;
using test::Made;
using testing::HasSubstr;

// ω⁺ = (I₁ω₁ + I₂ω₂)/(I₁ + I₂), and ½ I₁I₂/(I₁ + I₂) Δω² is lost.
TEST(ActingEvents, a_clutch_that_locks_keeps_the_momentum_and_says_what_it_lost) {
  const ActedRun run(discs(R"(time: {end: 3, output: 0.25}
events:
  grip: {hinge: clutch, value: 2, direction: up, do: {lock: clutch}}
  let_go: {after: grip, delay: 1, do: {unlock: clutch}}
)"));
  ASSERT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
  ASSERT_EQ(run.summary.events.size(), 2U);
  EXPECT_EQ(run.summary.events[0].name, "grip");
  EXPECT_EQ(run.summary.events[0].direction, 1);
  EXPECT_NEAR(run.summary.events[0].time, 0.5, 1e-12);
  EXPECT_EQ(run.summary.events[1].time, run.summary.events[0].time + 1);
  EXPECT_NEAR(run.rate("axle"), (0.2 * 1 + 0.3 * 5) / 0.5, 1e-13);
  EXPECT_EQ(run.rate("clutch"), 0.0);
  EXPECT_NEAR(run.event(0).loss, 0.5 * 0.2 * 0.3 / 0.5 * 16, 1e-12);
  EXPECT_NEAR(run.summary.final.y.back(), -run.event(0).loss, 1e-12);
  EXPECT_LT(run.summary.energy_drift, 1e-12);
  for (const State& s : run.outputs)
    if (s.time > 0.5) {
      EXPECT_EQ(run.position("clutch", s), run.position("clutch", run.summary.final)) << s.time;
    }
}

TEST(ActingEvents, a_boom_that_latches_keeps_the_momenta_of_its_satellite) {
  const std::string latch = "events: {latch: {hinge: root, value: 90 deg, direction: up, do: {lock: root}}}\n";
  for (const std::string formulation : {"quadratic", "exact"}) {
    SCOPED_TRACE(formulation);
    const ActedRun run(deployment(latch), formulation);
    ASSERT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
    ASSERT_EQ(run.summary.events.size(), 1U);
    EXPECT_TRUE(run.summary.momentum.conserved);
    EXPECT_LT(run.summary.energy_drift, 1e-8);
    EXPECT_EQ(run.rate("root"), 0.0);
    EXPECT_NEAR(run.position("root", run.summary.final), std::numbers::pi / 2, 1e-9);
    EXPECT_GT(run.event(0).loss, 0.1);
    EXPECT_EQ(run.rates(run.summary.final)[run.scene.model->layout().positions + 6], 0.0);
  }
}

/// The state after the scene's events at its initial time.
State after_events_at_start(const Made& made) {
  EventActions actions(*made.scene.model, *made.equations, {});
  State state = made.scene.initial;
  EXPECT_TRUE(actions.act(state, {}).evaluation.ok());
  return state;
}

const std::string bent = R"(initial:
  hinges: {base: {rate: [0.05, 0.1, 0.2, 0.3, -0.2, 0.1]}, root: {position: [0.7], rate: [0.9]}}
  bodies: {boom: {modes: [0.05, -0.01, 0.02], rates: [0.3, -0.2, 0.1]}}
)";

std::string bent_boom(const std::string& rest) {
  std::string text = deployment(rest);
  const std::size_t first = text.find("initial:"), last = text.find("time:");
  return text.replace(first, last - first, bent);
}

TEST(ActingEvents, impulses_act_on_nothing_but_the_hinge_that_locks) {
  for (const std::string formulation :
       {"quadratic", "exact", "linear", "ruthless", "inconsistent", "consistent", "symmetric"}) {
    SCOPED_TRACE(formulation);
    // The dense reference of exact kinematics agrees with the recursion to this.
    const double rounding = formulation == "exact" ? 1e-10 : 1e-12;
    const Made made(bent_boom("events: {now: {at: 0, do: {lock: root}}}\n"), formulation);
    const State after = after_events_at_start(made);
    const Layout& layout = made.scene.model->layout();
    std::vector<double> change(layout.speeds), impulse(layout.speeds), terms(layout.speeds);
    double greatest = 0;
    for (std::size_t i = 0; i < layout.speeds; ++i)
      change[i] = after.y[layout.positions + i] - made.scene.initial.y[layout.positions + i];
    const DenseSystem dense = made.equations->system(0, after.y);
    for (std::size_t i = 0; i < layout.speeds; ++i)
      for (std::size_t k = 0; k < layout.speeds; ++k) {
        const double term = dense.mass[i * layout.speeds + k] * change[k];
        impulse[i] += term;
        terms[i] += std::abs(term);
      }
    for (const double x : impulse) greatest = std::max(greatest, std::abs(x));
    const std::size_t locked = layout.hinge("root")->speed;
    EXPECT_EQ(std::abs(impulse[locked]), greatest);
    for (std::size_t i = 0; i < layout.speeds; ++i)
      if (i != locked) {
        EXPECT_LT(std::abs(impulse[i]), rounding * *std::max_element(terms.begin(), terms.end()))
            << layout.speed_names[i];
      }
    EXPECT_EQ(after.y[layout.positions + locked], 0.0);
    if (formulation == "quadratic" || formulation == "exact") {
      const Energies a = made.equations->energies(made.scene.initial.y), b = made.equations->energies(after.y);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.linear_momentum[k], b.linear_momentum[k], rounding);
        EXPECT_NEAR(a.angular_momentum[k], b.angular_momentum[k], rounding);
      }
    }
  }
}

// A damper c stops the hinge within some M/c: what it leaves of the modes' rates tends to the latch's as 1/c.
TEST(ActingEvents, a_latch_is_the_limit_of_a_stiff_damper) {
  const Made latched(bent_boom("events: {now: {at: 0, do: {lock: root}}}\n"));
  const State limit = after_events_at_start(latched);
  const Layout& layout = latched.scene.model->layout();
  std::vector<double> errors;
  for (const double damping : {1e5, 1e6}) {
    std::string text = bent_boom("");
    text.replace(text.find("stiffness: 4,"), 13, "damping: " + std::to_string(damping) + ",");
    Made damped(text);
    RunOptions options;
    options.end = 40 / damping;
    options.output = 1;
    const RunSummary summary = simulate(*damped.scene.model, *damped.equations, *damped.scene.integrator,
                                        damped.scene.initial, options, [](const State&) {});
    double error = 0;
    for (std::size_t i = layout.positions; i < layout.positions + layout.speeds; ++i)
      error = std::max(error, std::abs(summary.final.y[i] - limit.y[i]));
    errors.push_back(error);
  }
  EXPECT_LT(errors[1], 2e-3);
  EXPECT_NEAR(errors[0] / errors[1], 10, 2);
}

TEST(ActingEvents, a_body_that_is_released_flies_by_its_weight_alone) {
  const ActedRun run(R"(format: withy/1
gravity: [0, -9.81, 0]
integrator: {name: dop853, rtol: 1e-12, atol: 1e-13}
time: {end: 2, output: 0.25}
bodies:
  arm: {type: rigid, mass: 3, inertia: [0.2, 0.2, 0.4, 0, 0, 0], frames: {hand: {position: [0.8, 0, 0]}}}
  ball: {type: rigid, mass: 0.5, inertia: [0.01, 0.02, 0.03, 0, 0, 0]}
hinges:
  shoulder: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}
  grip: {type: weld, parent: arm.hand, child: ball}
initial: {hinges: {shoulder: {rate: [3]}}}
events: {throw: {at: 1, do: {release: ball}}}
)");
  ASSERT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
  EXPECT_LT(run.summary.energy_drift, 1e-10);
  EXPECT_EQ(run.event(0).loss, 0.0);
  const auto seen = run.equations->make_observation();
  const int ball = run.scene.model->body("ball");
  const auto motion = [&](const State& s) {
    seen->observe(s.y);
    return std::pair(seen->frame_pose(ball, 0).position, seen->frame_velocity(ball, 0));
  };
  const auto at = [&](double t) {
    return *std::find_if(run.outputs.begin(), run.outputs.end(), [&](const State& s) { return s.time == t; });
  };
  const auto [p, v] = motion(at(1));
  const double angle = run.position("shoulder", at(1));
  EXPECT_NEAR(p[0], 0.8 * std::cos(angle), 1e-12) << "welded until then";
  for (const double t : {1.25, 1.5, 2.0}) {
    const auto [position, velocity] = motion(at(t));
    const double d = t - 1;
    EXPECT_NEAR(position[0], p[0] + v.linear[0] * d, 1e-9);
    EXPECT_NEAR(position[1], p[1] + v.linear[1] * d - 0.5 * 9.81 * d * d, 1e-9);
    EXPECT_NEAR(velocity.angular[2], v.angular[2], 1e-9);
  }
}

// In any order of the list; none of the sets in between is one that an event leaves.
TEST(ActingEvents, hinges_that_one_event_locks_stop_as_by_two_at_one_instant_and_are_let_go_together) {
  const std::string time = "time: {end: 3, output: 0.25}\n", free = "do: {unlock: [axle, clutch]}}\n";
  const ActedRun two(discs(time + "events: {a: {at: 1, do: {lock: axle}}, b: {at: 1, do: {lock: clutch}}}\n"));
  const double kinetic = 0.5 * 0.2 * 1 + 0.5 * 0.3 * 25;
  for (const std::string list : {"[axle, clutch]", "[clutch, axle]"}) {
    const ActedRun one(discs(time + "events:\n  stop: {at: 1, do: {lock: " + list + "}}\n  go: {at: 2, " + free));
    ASSERT_EQ(one.summary.status, RunStatus::completed) << one.summary.message;
    EXPECT_NEAR(one.event(0).loss, kinetic, 1e-12);
    EXPECT_NEAR(one.event(0).loss, two.event(0).loss + two.event(1).loss, 1e-12);
    EXPECT_LT(one.summary.energy_drift, 1e-12);
    for (const char* hinge : {"axle", "clutch"}) {
      EXPECT_EQ(one.rate(hinge), 0.0);
      EXPECT_NEAR(one.position(hinge, one.summary.final), two.position(hinge, two.summary.final), 1e-13);
    }
    EXPECT_EQ(EventBook(*one.scene.model).locked(one.summary.final.y).size(), 0U);
  }
}

/// An upper and a lower arm under gravity on hinges of this type; `rest` follows.
std::string hung_arms(const std::string& type, const std::string& rest) {
  return R"(format: withy/1
gravity: [0, -9.81, 0]
integrator: {name: dop853, rtol: 1e-11, atol: 1e-13}
time: {end: 1, output: 0.1}
bodies:
  upper: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0], frames: {end: {position: [1, 0, 0]}}}
  lower: {type: rigid, mass: 1, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  shoulder: {)" +
         type + R"(, parent: world, child: upper}
  elbow: {)" +
         type + ", parent: upper.end, child: lower}\n" + rest;
}

TEST(ActingEvents, hinges_that_one_event_unlocks_move_as_those_that_were_free_at_first) {
  const std::string hinge = "type: revolute, axis: [0, 0, 1]";
  const ActedRun free(hung_arms(hinge, ""));
  const ActedRun freed(hung_arms(hinge,
                                 "initial: {time: -1, locked: [shoulder, elbow]}\n"
                                 "events: {go: {at: 0, do: {unlock: [elbow, shoulder]}}}\n"));
  ASSERT_EQ(freed.summary.status, RunStatus::completed) << freed.summary.message;
  EXPECT_LT(freed.summary.energy_drift, 1e-9);
  for (const char* name : {"shoulder", "elbow"})
    EXPECT_NEAR(freed.position(name, freed.summary.final), free.position(name, free.summary.final), 1e-9);
}

TEST(ActingEvents, bodies_that_one_event_releases_fall_side_by_side) {
  const ActedRun run(hung_arms("type: weld", "events: {drop: {at: 0.3, do: {release: [upper, lower]}}}\n"));
  ASSERT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
  const auto seen = run.equations->make_observation();
  seen->observe(run.summary.final.y);
  for (const auto& [body, x] : {std::pair("upper", 0.0), std::pair("lower", 1.0)}) {
    const auto position = seen->frame_pose(run.scene.model->body(body), 0).position;
    EXPECT_NEAR(position[0], x, 1e-10);
    EXPECT_NEAR(position[1], -0.5 * 9.81 * 0.7 * 0.7, 1e-9);
  }
}

TEST(ActingEvents, a_latch_at_high_speed_is_named_where_it_ends_the_run) {
  const ActedRun run(R"(format: withy/1
time: {end: 1, output: 0.5}
bodies:
  bus: {type: rigid, mass: 10, inertia: [4, 4, 4, 0, 0, 0]}
  boom: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 5, modes: 2}}
hinges:
  float: {type: free, parent: world, child: bus}
  turn: {type: revolute, axis: [0, 0, 1], parent: bus, child: boom}
initial: {hinges: {turn: {rate: [3000]}}}
events: {latch: {hinge: turn, value: 1, direction: up, do: {lock: turn}}}
)");
  EXPECT_EQ(run.summary.status, RunStatus::diverged);
  EXPECT_THAT(run.summary.message, HasSubstr("event 'latch' locked hinges that moved: its impulses took 5.339e+04 J"));
}

// A level arm of 2 kg whose weight acts 0.35 m from its hinge: what holds it is 2 · 9.81 · 0.35 N m, and nothing once
// it is let go. The spring adds its own.
TEST(ActingEvents, what_holds_a_locked_hinge_is_the_effort_of_a_motion) {
  const Made made(R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 2}
bodies: {arm: {type: rigid, mass: 2, center_of_mass: [0.35, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
loads: {spring: {type: hinge-spring, hinge: pin, stiffness: 10, free_position: 0.1}}
outputs:
  held: {type: effort, hinge: pin, of: motion}
  whole: {type: effort, hinge: pin}
events: {let_go: {at: 1, do: {unlock: pin}}}
initial: {locked: [pin]}
)");
  SensorReader sensors(made.scene.outputs, *made.equations);
  const double weight = 2 * 9.81 * 0.35;
  std::vector<double> values(2);
  ASSERT_EQ(sensors.columns().size(), values.size());
  ASSERT_TRUE(sensors.read(made.scene.initial, values));
  EXPECT_NEAR(values[0], weight - 1, 1e-12);
  EXPECT_NEAR(values[1], weight, 1e-12);
  State free = made.scene.initial;
  EventBook(*made.scene.model).set_configuration(free.y, 0);
  ASSERT_TRUE(sensors.read(free, values));
  EXPECT_EQ(values[0], 0);
  EXPECT_NEAR(values[1], 1, 1e-12);
}

}  // namespace
}  // namespace withy
