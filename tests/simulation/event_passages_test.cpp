/// \file
/// Every passage of an event's value is one: it is told once and acts once, whatever side of the value rounding leaves
/// the state on that a step is made to end at.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "acted_run.hpp"

namespace withy {
namespace {

using test::ActedRun;

// x = cos 2t of a disc on a spring, and events that act on a spring which the motion knows nothing of: they are to
// happen where x or its rate passes their values, one way and the other in turn.
std::string swinging_disc(const std::string& integrator, const std::string& events) {
  return "format: withy/1\nintegrator: " + integrator + R"(
time: {end: 12, output: 12}
bodies:
  disc: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  other: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disc}
  idle: {type: revolute, axis: [0, 0, 1], parent: world, child: other}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 0.8}
  idle_spring: {type: hinge-spring, hinge: idle, stiffness: 1}
outputs: {turn: {type: gyro, of: disc}, pull: {type: hinge, hinge: axle}}
initial: {hinges: {axle: {position: 1}}}
)" + events;
}

/// Times [s] up to `end` at which cos 2t passes a value.
std::vector<double> passages(double value, double end) {
  std::vector<double> times;
  const double first = std::acos(value) / 2;
  for (double begin = 0; begin < end; begin += std::numbers::pi) {
    if (begin + first < end) times.push_back(begin + first);
    if (begin + std::numbers::pi - first < end) times.push_back(begin + std::numbers::pi - first);
  }
  return times;
}

TEST(EventPassages, act_once_each_and_in_turn_downwards_and_upwards) {
  constexpr int events = 15;
  // What watches the coordinate, its rate −2 sin 2t and its acceleration −4 cos 2t: of all the same cosine passes.
  const struct {
    std::string watch;
    double scale, shift;
  } signals[] = {
      {"hinge: axle", 1, 0}, {"signal: turn.z", 2, -std::numbers::pi / 4}, {"signal: pull.acceleration", -4, 0}};
  for (const std::string integrator :
       {"{name: dopri5, rtol: 1e-9, atol: 1e-11}", "{name: dop853, rtol: 1e-9, atol: 1e-11}",
        "{name: radau, rtol: 1e-9, atol: 1e-11}", "{name: cvode, rtol: 1e-9, atol: 1e-11}",
        "{name: gauss, step: 0.01}"}) {
    for (const auto& signal : signals) {
      std::string text = "events:\n";
      for (int i = 0; i < events; ++i)
        text += fmt::format(
            "  e{}: {{{}, value: {}, direction: both, repeat: true, do: {{set: loads.idle_spring.stiffness={}}}}}\n", i,
            signal.watch, signal.scale * (-0.9 + 0.12 * i), 2 + i);
      const ActedRun run(swinging_disc(integrator, text));
      for (int i = 0; i < events; ++i) {
        std::vector<double> expected = passages(-0.9 + 0.12 * i, 12 - signal.shift);
        std::vector<EventTime> found;
        for (const EventTime& e : run.summary.events)
          if (e.name == "e" + std::to_string(i)) found.push_back(e);
        for (double& t : expected) t += signal.shift;
        std::erase_if(expected, [](double t) { return t < 0; });
        ASSERT_EQ(found.size(), expected.size()) << integrator << signal.watch << i;
        EXPECT_EQ(run.event(static_cast<std::size_t>(i)).happened, static_cast<double>(found.size()));
        for (std::size_t k = 1; k < found.size(); ++k)
          EXPECT_EQ(found[k].direction, -found[k - 1].direction) << integrator << signal.watch << i;
        // Integration to 1e-9, or of order four in a hundredth: errors of x over its rate, at least 0.8 here.
        for (std::size_t k = 0; k < found.size(); ++k)
          EXPECT_NEAR(found[k].time, expected[k], 1e-6) << integrator << signal.watch << i;
      }
    }
  }
}

// A value with a unit is one of what is watched, which an expression gives in degrees.
TEST(EventPassages, of_values_with_a_unit_are_those_of_the_signal_in_its_own) {
  std::string scene = swinging_disc("{name: dopri5, rtol: 1e-9, atol: 1e-11}", "");
  const std::string last = "pull: {type: hinge, hinge: axle}";
  scene.insert(scene.find(last) + last.size(),
               ", in_degrees: {type: expression, value: pull.position * 180 / pi, unit: deg}");
  const std::vector<std::string> values = {"30", "\"30 deg\"", fmt::format("\"{} rad\"", std::numbers::pi / 6)};
  for (const std::string& value : values) {
    const ActedRun run(scene + "events: {e: {signal: in_degrees, value: " + value + ", repeat: true}}\n");
    const std::vector<double> expected = passages(std::numbers::pi / 6, 12);
    ASSERT_EQ(run.summary.events.size(), expected.size()) << value;
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(run.summary.events[k].time, expected[k], 1e-7) << value;
  }
}

// An event that waits does not look; those that do are not told more than there is.
TEST(EventPassages, of_an_event_with_a_delay_act_once_each_and_are_no_passages_of_others) {
  for (const std::string direction : {"both", "down", "up"}) {
    const std::string watch = "hinge: axle, value: 0.3, direction: " + direction;
    const ActedRun run(
        swinging_disc("{name: dopri5, rtol: 1e-9, atol: 1e-11}",
                      "events:\n  late: {" + watch +
                          ", delay: 0.1, repeat: true, do: {set: loads.idle_spring.stiffness=3}}\n  silent: {" + watch +
                          ", delay: 0.1, repeat: true}\n  seen: {" + watch + "}\n"));
    for (const std::string name : {"late", "silent", "seen"}) {
      const double delay = name == "seen" ? 0 : 0.1;
      std::vector<double> expected = passages(0.3, 12 - delay);
      if (direction != "both")
        std::erase_if(expected, [&](double t) { return (std::sin(2 * t) > 0) != (direction == "down"); });
      std::vector<double> found;
      for (const EventTime& e : run.summary.events)
        if (e.name == name) found.push_back(e.time);
      ASSERT_EQ(found.size(), expected.size()) << direction << name;
      for (std::size_t k = 0; k < found.size(); ++k)
        EXPECT_NEAR(found[k], expected[k] + delay, 1e-7) << direction << name;
    }
  }
}

/// Rate [rad/s] after 10 s of 1 kg m² that starts with `rate` at angle 0, where its motor is off, and is driven by
/// `torque` while cos(angle) rises above and is above `value`: from passage to passage; and how many there are.
std::pair<double, int> driven_by_its_place(double rate, double value, double torque) {
  const double half = std::acos(value), turn = 2 * std::numbers::pi;
  double t = 0, angle = 0, target = half;
  for (int passages = 0;; ++passages) {
    const bool on = passages > 0 && passages % 2 == 0, up = passages % 2 == 1;
    const double acceleration = on ? torque : 0;
    const double there = std::sqrt(rate * rate + 2 * acceleration * (target - angle));
    const double span = 2 * (target - angle) / (rate + there);
    if (t + span > 10) return {rate + acceleration * (10 - t), passages};
    t += span, angle = target, rate = there;
    target += up ? 2 * half : turn - 2 * half;
  }
}

// One event looks for the way up, another for the way down of one number: where the step ends on the first, rounding
// says which side the second begins on, and the way down comes before the step's first look.
TEST(EventPassages, of_a_turning_place_switch_its_motor_on_and_off_in_turn) {
  const struct { double rate, value, torque; } motors[] = {{10, 0.999, 20}, {30, 0.99, 50}, {100, 0.999, 500}};
  for (const std::string integrator : {"dopri5", "dop853", "radau"}) {
    for (const auto& motor : motors) {
      const ActedRun run(fmt::format(
          "format: withy/1\ntime: {{end: 10, output: 10}}\nintegrator: {}\n"
          "bodies: {{disc: {{type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0], frames: {{mark: {{position: [1, 0, "
          "0]}}}}}}}}\n"
          "hinges: {{axle: {{type: revolute, axis: [0, 0, 1], parent: world, child: disc}}}}\n"
          "outputs: {{place: {{type: frame, of: disc.mark, show: position}}}}\n"
          "loads: {{motor: {{type: hinge-effort, hinge: axle, law: constant, value: {}}}}}\n"
          "initial: {{hinges: {{axle: {{rate: {}}}}}, settings: {{motor: off}}}}\n"
          "events:\n"
          "  up: {{signal: place.x, value: {}, direction: up, repeat: true, do: {{switch_on: motor}}}}\n"
          "  down: {{signal: place.x, value: {}, direction: down, repeat: true, do: {{switch_off: motor}}}}\n",
          integrator, motor.torque, motor.rate, motor.value, motor.value));
      const auto [rate, count] = driven_by_its_place(motor.rate, motor.value, motor.torque);
      EXPECT_EQ(run.summary.events.size(), static_cast<std::size_t>(count)) << integrator << motor.rate;
      // Within a passage torque is constant, which each step integrates exactly; instants are known to rounding.
      EXPECT_NEAR(run.rate("axle"), rate, 1e-9 * rate) << integrator << motor.rate;
    }
  }
}

/// 2 kg that 2 N push from rest; events follow.
std::string pushed_mass(const std::string& events) {
  return R"(format: withy/1
time: {end: 3, output: 3}
bodies: {m: {type: rigid, mass: 2}}
hinges: {x: {type: prismatic, axis: [1, 0, 0], parent: world, child: m}}
outputs: {f: {type: frame, of: m}}
loads: {push: {type: hinge-effort, hinge: x, value: 2}, idle: {type: hinge-effort, hinge: x, value: 0}}
events:
)" + events;
}

/// "r up at 1": in the order in which they are told; times to 1e-9.
std::vector<std::string> told(const RunSummary& summary) {
  std::vector<std::string> lines;
  for (const EventTime& e : summary.events)
    lines.push_back(fmt::format("{}{} at {:.9g}", e.name,
                                e.direction == 0  ? ""
                                : e.direction > 0 ? " up"
                                                  : " down",
                                e.time));
  return lines;
}

// Each time the mass has 1 m/s, after 1 s, the lock takes it in no time.
TEST(EventPassages, that_another_event_makes_at_the_same_instant_are_told_and_acted_on) {
  const std::string lock = R"(  lk: {signal: f.vx, value: 1, direction: up, repeat: true, do: {lock: x}}
  ul: {after: lk, delay: 0.3, repeat: true, do: {unlock: x}}
)";
  // What reports, by an output or by the coordinate, and what acts on something else.
  for (const std::string watch : {"{signal: f.vx, value: 1}", "{hinge: x, of: rate, value: 1}",
                                  "{signal: f.vx, value: 1, repeat: true, do: {set: loads.idle.value=0}}"}) {
    const ActedRun run(pushed_mass("  r: " + watch + "\n" + lock));
    EXPECT_EQ(told(run.summary),
              (std::vector<std::string>{"r up at 1", "lk up at 1", "r down at 1", "ul at 1.3", "r up at 2.3",
                                        "lk up at 2.3", "r down at 2.3", "ul at 2.6"}))
        << watch;
  }
}

// What looks for the way down alone has passed on the way up, whatever side rounding leaves the step's end on.
TEST(EventPassages, back_of_a_value_that_nobody_looks_for_on_the_way_there_are_seen) {
  const ActedRun run(
      pushed_mass(R"(  r: {signal: f.vx, value: 1, direction: down, repeat: true, do: {set: loads.idle.value=0}}
  lk: {signal: f.vx, value: 1, direction: up, repeat: true, do: {lock: x}}
  ul: {after: lk, delay: 0.3, repeat: true, do: {unlock: x}}
)"));
  EXPECT_EQ(told(run.summary), (std::vector<std::string>{"lk up at 1", "r down at 1", "ul at 1.3", "lk up at 2.3",
                                                         "r down at 2.3", "ul at 2.6"}));
}

TEST(EventPassages, that_an_event_makes_by_its_own_action_are_none_that_it_waits_for) {
  const ActedRun run(pushed_mass(R"(  lk: {signal: f.vx, value: 1, repeat: true, do: {lock: x}}
  ul: {after: lk, delay: 0.3, repeat: true, do: {unlock: x}}
)"));
  EXPECT_EQ(told(run.summary), (std::vector<std::string>{"lk up at 1", "ul at 1.3", "lk up at 2.3", "ul at 2.6"}));
}

// The push jumps from 0 to 10 N at 1 s, and an event takes it away at the same instant.
TEST(EventPassages, there_and_back_at_the_instant_of_a_jump_are_both_at_that_instant) {
  for (const std::string integrator : {"{name: rk4, step: 0.5}", "{name: dopri5}", "{name: radau}"}) {
    const ActedRun run("format: withy/1\nintegrator: " + integrator + R"(
time: {end: 3, output: 3}
bodies: {m: {type: rigid, mass: 2}}
hinges: {x: {type: prismatic, axis: [1, 0, 0], parent: world, child: m}}
initial: {hinges: {x: {rate: [1]}}}
loads: {push: {type: hinge-effort, hinge: x, law: steps, table: [[0, 0], [1, 10], [2, 0]]}}
outputs: {imu: {type: accelerometer, of: m}}
events:
  dn: {signal: imu.x, value: 2}
  cut: {at: 1, do: {switch_off: push}}
)");
    ASSERT_EQ(told(run.summary), (std::vector<std::string>{"dn up at 1", "cut at 1", "dn down at 1"})) << integrator;
    for (const EventTime& e : run.summary.events) EXPECT_EQ(e.time, 1) << integrator << e.name;
    EXPECT_NEAR(run.rate("x"), 1, 1e-12) << integrator;
  }
}

// After an event steps begin anew, some of them far shorter than the zero is known to.
TEST(EventPassages, act_once_where_the_steps_after_them_are_next_to_nothing) {
  for (const std::string integrator : {"{name: cvode}", "{name: cvode, rtol: 1e-9, atol: 1e-11}",
                                       "{name: dopri5, initial_step: 1e-13}", "{name: dop853, initial_step: 1e-13}",
                                       "{name: radau, initial_step: 1e-13}", "{name: imex, initial_step: 1e-13}"}) {
    for (const std::string direction : {"up", "down", "both"}) {
      const ActedRun run(swinging_disc(integrator, "events: {pass: {hinge: axle, value: 0, direction: " + direction +
                                                       ", repeat: true, do: {set: loads.idle_spring.stiffness=2}}}\n"));
      ASSERT_EQ(run.summary.status, RunStatus::completed) << integrator << ": " << run.summary.message;
      // cos 2t passes zero at π/4, 3π/4 … : eight times in 12 s, first down.
      EXPECT_EQ(run.summary.events.size(), direction == "both" ? 8U : 4U) << integrator << ", " << direction;
    }
  }
}

}  // namespace
}  // namespace withy
