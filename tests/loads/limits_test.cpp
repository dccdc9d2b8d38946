// What controllers and actuators tell of themselves: tracking errors, margins to limits and the events there, delays;
// and what is said where a formula has no value.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using std::numbers::pi;
using test::LoadedScene;
using test::Shown;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names(const Shown& s) {
  std::vector<std::string> all;
  for (const Column& c : s.columns) all.push_back(c.name + "[" + c.unit + "]");
  return all;
}

/// A heavy arm of two joints, and a slide that is left alone.
const std::string limited_arm = R"(format: withy/1
gravity: [0, -9.81, 0]
time: {end: 1, output: 0.05}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies:
  a: {type: rigid, mass: 4, center_of_mass: [0.2, 0, 0], inertia: [0.2, 0.3, 0.15, 0, 0, 0], frames: {end: {position: [0.5, 0, 0]}}}
  b: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
hinges:
  one: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  two: {type: revolute, axis: [0, 0, 1], parent: a.end, child: b}
)";

/// A force and a torque from one law: each is told in the unit of its place.
TEST(Control, CommandsOfSeveralPlacesHaveTheirOwnUnits) {
  const Shown s(limited_arm + R"(
outputs: {c: {type: control, of: law}}
loads:
  turn: {type: input, hinge: two}
  push: {type: input, frame: a.end, direction: [0, 1, 0]}
  law: {type: state-space, of: one, to: [turn, push], A: [[-1]], B: [[1]], C: [[1], [2]]}
)");
  EXPECT_THAT(names(s), testing::IsSupersetOf({"c.command.0[N m]", "c.command.1[N]"}));
}

/// All that follows trajectories tells its efforts and how far the hinges are from them.
TEST(Tracking, ErrorsAreThoseOfTheTrajectory) {
  const auto r = [](double t) {
    const double s = std::min(t / 0.8, 1.0);
    return 0.9 * s * s * s * (10 - 15 * s + 6 * s * s);
  };
  for (const std::string load :
       {"pd-controller, duration: 0.8, hinges: {one: {to: 0.9, stiffness: 300, damping: 30}, two: {stiffness: 90, "
        "damping: 9}}",
        "pd-controller, sample: 0.05, duration: 0.8, hinges: {one: {to: 0.9, stiffness: 100, damping: 10}, two: "
        "{stiffness: 30, damping: 3}}",
        "computed-torque, bandwidth: 8, duration: 0.8, hinges: {one: {to: 0.9}, two: {}}",
        "rigid-inverse-dynamics, duration: 0.8, hinges: {one: {to: 0.9}, two: {}}"}) {
    const Shown s(limited_arm +
                  "outputs:\n  servo: {type: control, of: drive}\n  effort: {type: effort, hinge: two}\n  seen: "
                  "{type: hinge, hinge: one}\nloads:\n  drive: {type: " +
                  load + "}\n");
    const std::vector<std::string> all = names(s);
    EXPECT_EQ(all[0], "servo.command.one[N m]");
    EXPECT_EQ(all[1], "servo.command.two[N m]");
    EXPECT_EQ(all[2], "servo.error.one[rad]");
    EXPECT_EQ(all[3], "servo.error.two[rad]");
    const bool sampled = load.find("sample") != std::string::npos;
    for (std::size_t k = 0; k < s.times.size(); ++k) {
      // By the clock it is that of the last sample: a row shows what was held until its own, but for the first and
      // last.
      const std::size_t of = sampled && k > 0 && k + 1 < s.times.size() ? k - 1 : k;
      ASSERT_NEAR(s["servo.error.one"][k], r(s.times[of]) - s["seen.position"][of], 1e-12) << load << s.times[k];
      ASSERT_NEAR(s["servo.command.two"][k], s["effort"][k], 1e-12 * (1 + std::abs(s["effort"][k]))) << load;
    }
  }
  const Shown one(test::turntable +
                  "outputs: {c: {type: control, of: drive, show: [error, margin]}}\nloads: {drive: {type: "
                  "pd-controller, law: constant, hinges: {axle: {to: 0.5, stiffness: 5, damping: 1, limit: 2}}}}\n");
  EXPECT_THAT(names(one), ElementsAre("c.error[rad]", "c.margin[N m]"));
  EXPECT_DOUBLE_EQ(one["c.margin"][0], 2 - 5 * 0.5);
}

// J ẍ = min(2, 5 (1 − x)) from rest with J = 0.2: x = 5t² until 1 − x = 0.4, then a swing at 5 rad/s of amplitude 0.8
// about 1, which is 0.4 beyond it a fifteenth of π later.
TEST(Limits, AreEventsAtTheTimesWhereDemandsPassThem) {
  const std::string servo = "loads:\n  servo: {type: pid, hinge: axle, proportional: 5, reference: 1, limit: 2}\n";
  LoadedScene s(test::turntable + servo +
                "events:\n  free: {limit: servo, direction: down}\n  full: {limit: servo, direction: up}\n");
  const std::vector<State> all = s.run();
  ASSERT_EQ(s.summary.events.size(), 4U) << "one each, and no chattering";
  const double leaves = std::sqrt(0.12), reaches = leaves + pi / 15;
  EXPECT_EQ(s.summary.events[0].name, "free");
  EXPECT_NEAR(s.summary.events[0].time, leaves, 1e-9);
  EXPECT_EQ(s.summary.events[1].name, "full");
  EXPECT_NEAR(s.summary.events[1].time, reaches, 1e-9);
  // Beyond the limit at −10 rad/s² from the rate with which it got there, and back.
  const double rate = 0.8 * 5 * std::cos(pi / 6);
  EXPECT_NEAR(s.summary.events[2].time, reaches + 2 * rate / 10, 1e-9);
  LoadedScene unwatched(test::turntable + servo);
  EXPECT_NEAR(unwatched.position(unwatched.run().back(), "axle"), s.position(all.back(), "axle"), 1e-8);
}

TEST(Limits, OfActuatorsWheelsAndStopsAreEventsToo) {
  const auto times = [](const std::string& loads, const std::string& limited) {
    LoadedScene s(test::turntable + "loads:\n" + loads + "events: {reached: {limit: " + limited +
                  ", direction: up, do: {}}, left: {limit: " + limited + ", direction: down}}\n");
    s.run();
    std::vector<double> all;
    for (const EventTime& event : s.summary.events) all.push_back(event.time);
    return all;
  };
  const std::string wave = "  wave: {type: expression, value: 3 * sin(t), to: nothing}\n";
  const double at = std::asin(2 / 3.0);
  EXPECT_THAT(times(wave + "  drive: {type: actuator, of: wave, hinge: axle, frequency: 50, limit: 2}\n", "drive"),
              ElementsAre(testing::DoubleNear(at, 1e-9)));
  EXPECT_THAT(times(wave + "  motor: {type: dc-motor, of: wave, hinge: axle, resistance: 2, torque_constant: 0.01, "
                           "voltage_limit: 2}\n",
                    "motor"),
              ElementsAre(testing::DoubleNear(at, 1e-9)));
  // 0.4 N m on 0.2 kg m² turns by t².
  EXPECT_THAT(times("  push: {type: hinge-effort, hinge: axle, value: 0.4}\n  stop: {type: hinge-limit, hinge: axle, "
                    "upper: 1, stiffness: 1000}\n",
                    "stop"),
              testing::Contains(testing::DoubleNear(1, 1e-9)));
  EXPECT_THAT(test::problem_of(test::turntable + "loads: {push: {type: hinge-effort, hinge: axle, value: 1}}\nevents: "
                                                 "{a: {limit: push}, b: {limit: pusj}}\n"),
              testing::AllOf(HasSubstr("load 'push' tells of no limit"), HasSubstr("did you mean 'push'?")));
}

// By the clock demands jump: the limit is reached at a sample.
TEST(Limits, OfSampledControllersAreReachedAtSamples) {
  LoadedScene s(test::turntable + R"(loads:
  servo: {type: pid, hinge: axle, integral: 1, sample: 0.1, limit: 0.5, anti_windup: none, reference: [[0, 1], [2, 1]]}
events: {full: {limit: servo, direction: up}}
)");
  s.run();
  ASSERT_EQ(s.summary.events.size(), 1U);
  EXPECT_NEAR(std::remainder(s.summary.events[0].time, 0.1), 0, 1e-12);
}

/// A swing of 1 Hz is at zero at each sample, where nothing is asked for: what it would ask for between them, up to
/// twice the limit, it never does.
TEST(Limits, OfSampledControllersAreNotReachedBetweenSamples) {
  for (const std::string servo :
       {"pid, hinge: axle, proportional: 1, limit: 0.5, sample: 1",
        "pid, of: seen.position, hinge: axle, proportional: 1, limit: 0.5, sample: 1, delay: 1",
        "pd-controller, law: constant, sample: 1, hinges: {axle: {stiffness: 1, damping: 0, limit: 0.5}}"}) {
    Shown s(test::turntable + R"(initial: {hinges: {axle: {rate: [6.283185307179586]}}}
outputs: {seen: {type: hinge, hinge: axle}, c: {type: control, of: servo}}
loads:
  spring: {type: hinge-spring, hinge: axle, stiffness: 7.895683520871486}
  servo: {type: )" +
                servo + "}\nevents: {full: {limit: servo, direction: up}, free: {limit: servo, direction: down}}\n",
            {"time={end: 4.5, output: 0.05}"});
    EXPECT_TRUE(s.scene.summary.events.empty()) << servo;
    for (std::size_t k = 0; k < s.times.size(); ++k) {
      ASSERT_NEAR(s["c.error"][k], 0, 1e-6) << servo << ", " << s.times[k];
      ASSERT_NEAR(s["c.margin"][k], 0.5, 1e-6) << servo << ", " << s.times[k];
    }
  }
}

/// 2 kg are pushed by 3 N from 0.15 s on, which the accelerometer shows, and the controller learns at its next sample.
TEST(Limits, OfSampledControllersOfAccelerationsAreReachedAtTheirSamples) {
  Shown s(R"(format: withy/1
time: {end: 0.35, output: 0.1}
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
outputs: {imu: {type: accelerometer, of: cart}, c: {type: control, of: servo}}
loads:
  push: {type: hinge-effort, hinge: slide, law: steps, table: [[0, 0], [0.15, 3]]}
  servo: {type: pid, of: imu.x, to: nothing, proportional: 4, limit: 5, sample: 0.1}
events: {full: {limit: servo, direction: up}}
)");
  ASSERT_EQ(s.scene.summary.events.size(), 1U);
  EXPECT_NEAR(s.scene.summary.events[0].time, 0.2, 1e-12);
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double felt = s.times[k] < 0.25 ? 0 : 1.5;  // the row at a sample shows what was held until then
    EXPECT_NEAR(s["c.error"][k], -felt, 1e-12) << s.times[k];
    EXPECT_NEAR(s["c.margin"][k], 5 - 4 * felt, 1e-12) << s.times[k];
    EXPECT_NEAR(s["c.command"][k], -std::min(4 * felt, 5.0), 1e-12) << s.times[k];
  }
}

TEST(Delay, OfAContinuousSignalIsPadesToItsOrder) {
  for (const auto& [order, error] : {std::pair(2, 1e-2), {4, 1e-6}, {7, 1e-8}}) {
    const Shown s(
        test::turntable + "outputs: {c: {type: control, of: late, show: command}}\nloads:\n  wave: {type: " +
            "expression, value: sin(2 * t), to: nothing}\n  late: {type: delay, of: wave, time: 0.4, order: " +
            std::to_string(order) + "}\n",
        {"time.end=12", "time.output=0.1"});
    const std::vector<double> c = s["c.command"];
    for (std::size_t k = 0; k < c.size(); ++k)
      if (s.times[k] > 8) {
        ASSERT_NEAR(c[k], std::sin(2 * (s.times[k] - 0.4)), error) << order;
      }
  }
  EXPECT_THAT(test::problem_of(test::turntable + "loads: {c: {type: pid, hinge: axle, proportional: 1, delay: 0.1}}\n"),
              HasSubstr("put a load of type 'delay' between"));
}

// What was on its way when the load was switched off has gone by when it is on again.
TEST(Delay, OfASampledControllerGoesOnWhileItIsOff) {
  const Shown s(test::turntable + R"(outputs: {u: {type: effort, hinge: axle}}
loads: {one: {type: expression, value: 1 + 0 * t, hinge: axle, sample: 0.1, delay: 0.3}}
events: {off: {at: 0.55, do: {switch_off: one}}, on: {at: 1.05, do: {switch_on: one}}}
)");
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double t = s.times[k];
    const bool acts = (t > 0.301 && t < 0.549) || t > 1.401;
    const bool idle = t < 0.299 || (t > 0.551 && t < 1.399);
    if (acts) {
      ASSERT_EQ(s["u"][k], 1) << t;
    }
    if (idle) {
      ASSERT_EQ(s["u"][k], 0) << t;
    }
  }
}

// Each command acts 0.3 s after its sample, also where the load is off for less than a sample until one: those on their
// way move up once then.
TEST(Delay, OfASampledControllerIsTheSameWhereItIsSwitchedOnAtASample) {
  const Shown s(test::turntable + R"(outputs: {u: {type: effort, hinge: axle}}
loads: {one: {type: expression, value: t, hinge: axle, sample: 0.1, delay: 0.3}}
events: {off: {at: 0.95, do: {switch_off: one}}, on: {at: 1.0, do: {switch_on: one}}}
)");
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double t = s.times[k], since = std::remainder(t, 0.1);
    if (t < 0.301 || t > 1.6 || std::abs(since) < 1e-3 || std::abs(t - 0.95) < 1e-3) continue;
    ASSERT_NEAR(s["u"][k], t > 0.95 && t < 1 ? 0 : std::floor(10 * t) / 10 - 0.3, 1e-12) << t;
  }
}

TEST(HingeEffort, IsOfTheLawThatItsValuesAreOf) {
  const auto end = [](const std::string& law) {
    LoadedScene s(test::turntable + "loads: {push: {type: hinge-effort, hinge: axle, " + law + "}}\n");
    return s.run().back().y;
  };
  EXPECT_EQ(end("value: 0.3"), end("law: constant, value: 0.3"));
  EXPECT_EQ(end("amplitude: 0.3, period: 1"), end("law: sine, amplitude: 0.3, period: 1"));
  const auto problem = [](const std::string& law) {
    return test::problem_of(test::turntable + "loads: {push: {type: hinge-effort, hinge: axle" + law + "}}\n");
  };
  EXPECT_THAT(problem(""), HasSubstr("needs a 'law', or a 'value', which is constant"));
  EXPECT_THAT(problem(", table: [[0, 0], [1, 1]]"), HasSubstr("a 'table' needs a 'law'"));
}

TEST(Formula, ThatDividesByZeroIsNoPeak) {
  LoadedScene s(test::turntable + "loads: {wild: {type: expression, value: 1/(t - 0.5) , hinge: axle}}\n");
  RunOptions options;
  options.end = 2;
  for (const double start : {0.0, 0.5}) {
    State from = s.scene.initial;
    from.time = start;
    const RunSummary summary = simulate(*s.scene.model, *s.equations, *s.scene.integrator, from, options, {});
    for (const double peak : summary.peak_effort) EXPECT_TRUE(std::isfinite(peak)) << start;
    if (start == 0.5) {
      EXPECT_THAT(summary.message, HasSubstr("load 'wild' gives"));
    }
  }
}

}  // namespace
}  // namespace withy
