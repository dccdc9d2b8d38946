/// \file
/// When events that act happen and in which order, what they set, and how runs, states and snapshots go on with them.
#include <gmock/gmock.h>

#include "acted_run.hpp"
#include "withy/core/simulation/session.hpp"

namespace withy {
namespace {

using test::ActedRun;
using test::deployment;
using test::discs;
using test::Made;
using testing::HasSubstr;

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

/// A block of 2 kg that a force along its slide moves from t = 1 s on.
std::string pushed(const std::string& setting) {
  return R"(format: withy/1
gravity: [0, 0, 0]
time: {end: 3, output: 1}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [0, 1, 0], parent: world, child: block}}
loads: {push: {type: force, frame: block, law: constant, value: [1, 0, 3]}}
events: {more: {at: 1, do: {set: ")" +
         setting + "\"}}}\n";
}

TEST(ActingEvents, set_components_of_lists_by_their_index) {
  EXPECT_NEAR(ActedRun(pushed("loads.push.value.1=4")).rate("slide"), 4, 1e-9);
  EXPECT_NEAR(ActedRun(pushed("loads.push.value=[1, 4, 3]")).rate("slide"), 4, 1e-9);
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

// The third multiple of 0.1 is not 0.3, nor the sum of 0.2 and 0.1.
TEST(ActingEvents, at_the_instant_of_a_sample_come_after_it_whatever_rounding_makes_of_the_two_times) {
  for (int k = 1; k <= 9; ++k) {
    for (const std::string& when :
         {"{at: 0." + std::to_string(k), "{after: first, delay: 0." + std::to_string(k - 1)}) {
      const ActedRun run(discs("time: {end: 0." + std::to_string(k) + R"(5, output: 1}
loads:
  motor: {type: hinge-effort, hinge: axle, value: 0}
  seen: {type: quantizer, of: table.acceleration, step: 0.001, range: 10, sample: 0.1}
outputs: {table: {type: hinge, hinge: axle}}
events:
  first: {at: 0.1}
  push: )" + when + ", do: {set: loads.motor.value=2}}\n"));
      ASSERT_EQ(run.event(1).happened, 1) << when;
      const LoadNode& seen = run.scene.model->loads()[1];
      const double held = seen.discrete(std::span(run.summary.final.y)).back();
      EXPECT_NEAR(held, 0, 1e-9) << when << ": the sample was taken before the push";
    }
  }
}

std::string problem_of(const std::string& text) {
  try {
    const Made made(text);
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

TEST(ActingEvents, tell_of_an_index_that_a_list_does_not_have) {
  EXPECT_THAT(problem_of(pushed("loads.push.value.3=4")),
              HasSubstr("/events/more/do/set: of /loads/push/value/3: got index \"3\"; need 0 to 2"));
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
