/// \file
/// Events that act: impulses, changes of loads, times, order, and what happens to checkpoints.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "made_scene.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/simulation/session.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {
namespace {

using test::Made;
using testing::HasSubstr;

/// A scene run to its end.
struct ActedRun : Made {
  explicit ActedRun(const std::string& text, const std::string& formulation = "") : Made(text, formulation) {
    RunOptions options;
    options.end = end_of_run(scene);
    options.output = scene.output;
    options.events = scene.events;
    summary = simulate(*scene.model, *equations, *scene.integrator, scene.initial, options,
                       [&](const State& s) { outputs.push_back(s); });
  }
  double position(const std::string& hinge, const State& s) const {
    return s.y[scene.model->layout().hinge(hinge)->position];
  }
  double rate(const std::string& hinge, const State& s) const {
    return s.y[scene.model->layout().positions + scene.model->layout().hinge(hinge)->speed];
  }
  double rate(const std::string& hinge) const { return rate(hinge, summary.final); }
  EventNumbers event(std::size_t index) const { return EventBook(*scene.model).numbers(summary.final.y, index); }
  Energies energies(const State& s) const { return equations->energies(s.y); }
  RunSummary summary;
  std::vector<State> outputs;
};

std::string problem_of(const std::string& text) {
  try {
    const Made made(text);
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

/// Discs of 0.2 and 0.3 kg m² on one axis, the second carried by the first; events follow.
std::string discs(const std::string& rest) {
  return R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies:
  one: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  two: {type: rigid, mass: 1, inertia: [0.2, 0.2, 0.3, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: one}
  clutch: {type: revolute, axis: [0, 0, 1], parent: one, child: two}
initial: {hinges: {axle: {rate: [1]}, clutch: {rate: [4]}}}
)" + rest;
}

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

std::string deployment(const std::string& rest) {
  return R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies:
  bus: {type: rigid, mass: 20, inertia: [3, 4, 5, 0.1, 0, 0], frames: {out: {position: [0.5, 0.1, 0]}}}
  boom:
    type: beam
    length: 2
    mass_per_length: 0.8
    bending_y: {stiffness: 60, modes: 2}
    bending_z: {stiffness: 90, modes: 1}
  tip: {type: rigid, mass: 1.5, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  base: {type: free, parent: world, child: bus}
  root: {type: revolute, axis: [0, 0, 1], parent: bus.out, child: boom}
  end: {type: weld, parent: boom.tip, child: tip}
loads: {motor: {type: hinge-spring, hinge: root, stiffness: 4, free_position: 110 deg}}
initial: {hinges: {base: {rate: [0.05, 0.1, 0.2, 0.3, -0.2, 0.1]}}}
time: {end: 4, output: 0.1}
)" + rest;
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

// J ω̇ = A sin(2πt/P): ω = AP/(2πJ) (1 − cos(2πt/P)), and the acceleration is half of its greatest at P/12.
TEST(ActingEvents, times_are_found_to_the_accuracy_of_the_integrator) {
  const ActedRun run(R"(format: withy/1
integrator: {name: dop853, rtol: 1e-12, atol: 1e-14}
time: {end: 2, output: 0.5}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {motor: {type: hinge-effort, hinge: axle, law: sine, amplitude: 3, period: 3}}
outputs: {arm: {type: hinge, hinge: axle}}
events:
  pull: {signal: arm.acceleration, value: 7.5, direction: up, do: {}}
  fast: {signal: axle.rate, value: 3.5809862195676447, direction: up, do: {switch_off: motor}, stop: true}
)");
  ASSERT_EQ(run.summary.events.size(), 2U);
  EXPECT_EQ(run.summary.events[0].name, "pull");
  EXPECT_NEAR(run.summary.events[0].time, 0.25, 1e-9);
  EXPECT_NEAR(run.summary.events[1].time, 0.5, 1e-9);
  EXPECT_THAT(run.summary.message, HasSubstr("'fast' ended the run"));
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

TEST(ActingEvents, loads_are_switched_and_their_numbers_set) {
  const ActedRun run(R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
time: {end: 9, output: 1}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {motor: {type: hinge-effort, hinge: axle, law: constant, value: 0.2}}
events:
  off: {at: 1, do: {switch_off: motor}}
  on: {after: off, delay: 1, do: {switch_on: motor}}
  more: {at: 3, do: {set: loads.motor.value=0.6}}
  done: {after: more, delay: 1, stop: true}
)");
  EXPECT_NEAR(run.summary.final.time, 4, 1e-12);
  EXPECT_NEAR(run.rate("axle", run.outputs[1]), 1, 1e-9);
  EXPECT_NEAR(run.rate("axle", run.outputs[2]), 1, 1e-9);
  EXPECT_NEAR(run.rate("axle", run.outputs[3]), 2, 1e-9);
  EXPECT_NEAR(run.rate("axle"), 5, 1e-9);
  EXPECT_LT(run.summary.energy_drift, 1e-9);
}

TEST(ActingEvents, at_one_instant_go_in_the_order_of_the_file_and_those_without_time_between_them_end_the_run) {
  const std::string both = R"(time: {end: 1, output: 0.5}
events:
  hold: {at: 0.5, do: {lock: clutch}}
  free: {at: 0.5, do: {unlock: clutch}}
)";
  const ActedRun run(discs(both));
  ASSERT_EQ(run.summary.events.size(), 2U);
  EXPECT_EQ(run.summary.events[0].name, "hold");
  EXPECT_EQ(run.summary.events[1].time, 0.5);
  EXPECT_NEAR(run.rate("axle"), 3.4, 1e-12) << "what locks for no time at all has its impulse";

  const ActedRun chatter(discs(R"(time: {end: 1, output: 0.5}
loads: {motor: {type: hinge-effort, hinge: clutch, law: constant, value: -1}}
outputs: {lever: {type: effort, hinge: clutch}}
events:
  start: {at: 0.5, do: {switch_off: motor}}
  on: {signal: lever, value: -0.5, direction: up, repeat: true, do: {switch_on: motor}}
  off: {signal: lever, value: -0.5, direction: down, repeat: true, do: {switch_off: motor}}
)"));
  EXPECT_EQ(chatter.summary.status, RunStatus::step_underflow);
  EXPECT_THAT(chatter.summary.message, HasSubstr("events follow each other without time between them"));
  EXPECT_EQ(chatter.summary.final.time, 0.5);

  const ActedRun missed(
      discs("time: {end: 1, output: 0.5}\nevents: {late: {hinge: clutch, value: 9, do: {lock: clutch}}}\n"));
  EXPECT_EQ(missed.summary.status, RunStatus::completed);
  EXPECT_THAT(missed.summary.message, HasSubstr("'late' did not happen"));
}

TEST(ActingEvents, that_cannot_be_are_each_told_with_their_place) {
  const std::string text = problem_of(discs(R"(time: {end: 1}
motions: {spin: {type: constant-rate, hinge: axle, rate: 1}}
events:
  a: {at: 1, do: {lock: clatch}}
  b: {at: 1, hinge: clutch, do: {unlock: clutch}}
  c: {do: {unlock: clutch}}
  d: {at: 1, do: {switch_off: motor}}
  e: {signal: clutch.rat, do: {lock: clutch}}
  f: {after: z, do: {lock: clutch}}
  g: {at: 1, do: {release: two}}
  h: {at: 1, do: {lock: axle}}
  i: {at: 1, do: {set: motor.value=3}}
)"));
  for (const char* part :
       {"no hinge \"clatch\"; did you mean 'clutch'?", "says more than one thing", "says nothing", "no load \"motor\"",
        "clutch.rate", "no event \"z\"", "which is no weld", "is moved by a motion", "need loads.NAME.PARAMETER=VALUE"})
    EXPECT_THAT(text, HasSubstr(part));
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

TEST(ActingEvents, a_final_state_goes_on_as_the_run_would_have) {
  const std::string events = R"(events:
  grip: {hinge: clutch, value: 2, direction: up, do: {lock: clutch, switch_off: motor}}
  let_go: {after: grip, delay: 1, do: {unlock: clutch}}
loads: {motor: {type: hinge-effort, hinge: axle, law: constant, value: 0.3}}
)";
  const ActedRun whole(discs("time: {end: 3, output: 1}\n" + events)),
      half(discs("time: {end: 1, output: 1}\n" + events));
  const std::string state = write_state(*half.scene.model, half.summary.final);
  EXPECT_THAT(state, HasSubstr(R"("locked":["clutch"],"settings":{"motor":"off"})"));
  std::string rest = discs("time: {end: 3, output: 1}\n" + events);
  rest.replace(rest.find("initial:"), rest.find("time:") - rest.find("initial:"), "initial: " + state + "\n");
  const ActedRun other(rest);
  ASSERT_EQ(other.scene.initial.y, half.summary.final.y);
  EXPECT_EQ(other.summary.events.size(), 1U);
  for (std::size_t i = 0; i < whole.summary.final.y.size(); ++i)
    EXPECT_NEAR(other.summary.final.y[i], whole.summary.final.y[i], 1e-10) << i;
}

TEST(ActingEvents, happen_in_a_session_as_in_a_run_and_snapshots_go_over_them) {
  const std::string text =
      deployment("events: {latch: {hinge: root, value: 90 deg, direction: up, do: {lock: root, switch_off: motor}}}\n");
  const ActedRun run(text);
  const Made made(text);
  Session session(*made.scene.model, *made.equations, *made.scene.integrator, made.scene.initial, {});
  const double latched = run.summary.events.at(0).time;
  ASSERT_TRUE(session.advance(latched - 0.01, false).reached);
  const Checkpoint before = session.snapshot();
  ASSERT_TRUE(session.advance(4, false).reached);
  ASSERT_EQ(session.events().size(), 1U);
  EXPECT_NEAR(session.events()[0].time, latched, 1e-10);
  const std::vector<double> end = session.state().y;
  session.restore(before);
  ASSERT_TRUE(session.advance(4, false).reached);
  EXPECT_EQ(session.state().y, end);
}

}  // namespace
}  // namespace withy
