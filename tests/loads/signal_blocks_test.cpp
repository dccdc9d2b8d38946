// Filters, parts of digital measurements, sums over time and scheduled gains, by what outputs show.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

#include "withy/tests/loads/shown_outputs.hpp"

namespace withy {
namespace {

using std::numbers::pi;
using test::LoadedScene;
using test::Shown;
using testing::HasSubstr;

/// Of a wave, from its last two values, a quarter of a period apart.
double amplitude_at_end(const std::vector<double>& x) { return std::hypot(x.back(), x[x.size() - 2]); }

TEST(Filter, HasButterworthsGainOfItsOrder) {
  for (const int order : {1, 2, 3, 5, 8}) {
    for (const double times : {0.5, 1.0, 2.0}) {
      const Shown s(test::turntable + "outputs: {f: {type: control, of: low, show: command}}\nloads:\n" +
                        "  wave: {type: expression, value: sin(2 * pi * 4 * t), to: nothing}\n"
                        "  low: {type: filter, of: wave, cutoff: " +
                        std::to_string(4 / times) + " Hz, order: " + std::to_string(order) + "}\n",
                    {"time.output=0.0625", "time.end=6", "integrator.rtol=1e-9"});
      EXPECT_NEAR(amplitude_at_end(s["f.command"]), 1 / std::sqrt(1 + std::pow(times, 2 * order)), 1e-6)
          << order << " at " << times;
    }
  }
}

TEST(Filter, BeginsSettledAndIsTheSameByTheClockForAHeldSignal) {
  const std::string text = R"(format: withy/1
gravity: [0, 0, -9.81]
time: {end: 0.5, output: 0.01}
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {held: {type: revolute, axis: [0, 0, 1], parent: world, child: block}}
outputs:
  imu: {type: accelerometer, of: block}
  a: {type: control, of: continuous, show: command}
  b: {type: control, of: sampled, show: command}
loads:
  continuous: {type: filter, of: imu.z, cutoff: 3 Hz, order: 3}
  sampled: {type: filter, of: imu.z, cutoff: 3 Hz, order: 3, sample: 0.01}
)";
  const Shown s(text);
  EXPECT_EQ(s.columns[3].unit, "m/s^2");
  for (const char* name : {"a.command", "b.command"})
    for (const double x : s[name]) ASSERT_NEAR(x, 9.81, 1e-9) << name;
}

TEST(Digital, AveragesAndQuantizersAreTheirClosedForms) {
  const Shown s(test::turntable + R"(outputs:
  mean: {type: control, of: average, show: command}
  steps: {type: control, of: converter, show: command}
  top: {type: control, of: most, show: command}
loads:
  ramp: {type: expression, value: t * (2 - t), to: nothing}
  line: {type: expression, value: t, to: nothing}
  average: {type: moving-average, of: line, window: 0.1, sample: 0.02}
  converter: {type: quantizer, of: line, step: 0.25, range: 1, sample: 0.02}
  most: {type: over-time, of: ramp, what: max, sample: 0.02}
)",
                {"time.output=0.02", "time.end=1.99"});
  const std::vector<double> mean = s["mean.command"], steps = s["steps.command"], top = s["top.command"];
  for (std::size_t k = 1; k + 1 < s.times.size(); ++k) {
    const double sampled = 0.02 * (static_cast<double>(k) - 1);  // a row shows what is held before its own sample
    double of_five = 0;
    for (int i = 0; i < 5; ++i) of_five += std::max(0.0, sampled - 0.02 * i) / 5;
    ASSERT_NEAR(mean[k], of_five, 1e-12) << k;
    ASSERT_NEAR(steps[k], std::min(1.0, 0.25 * std::round(sampled / 0.25)), 1e-12) << k;
    ASSERT_NEAR(top[k], sampled < 1 ? sampled * (2 - sampled) : 1, 1e-12) << k;
  }
}

/// A converter's numbers are multiples of its step, up to the last within the range; 0.6/0.2 is rounded below 3.
TEST(Digital, AQuantizerEndsWithTheLastStepWithinItsRange) {
  const auto last = [](const std::string& step, const std::string& range) {
    const Shown s(test::turntable +
                      "outputs: {q: {type: control, of: q, show: command}}\nloads:\n  line: {type: "
                      "expression, value: 3 * t - 3, to: nothing}\n  q: {type: quantizer, of: line, step: " +
                      step + ", range: " + range + ", sample: 0.02}\n",
                  {"time.output=0.02", "time.end=1.99"});
    const std::vector<double> q = s["q.command"];
    EXPECT_EQ(q.front(), -q.back());
    return q.back();
  };
  EXPECT_DOUBLE_EQ(last("0.25", "0.6"), 0.5);
  EXPECT_DOUBLE_EQ(last("0.2", "0.6"), 0.6);
  EXPECT_DOUBLE_EQ(last("0.25", "1"), 1);
  EXPECT_THAT(
      test::problem_of(test::turntable + "loads: {q: {type: quantizer, of: axle, step: 1, range: 0.5, sample: 0.1}}\n"),
      testing::AllOf(HasSubstr("/loads/q/range"), HasSubstr("is less than the 'step'")));
}

TEST(Digital, NoiseIsNormalAndDependsOnSeedAndSampleAlone) {
  const std::string text = test::turntable + R"(outputs: {n: {type: control, of: noise, show: command}}
loads: {noise: {type: noise, deviation: 0.3, seed: 11, sample: 0.001}}
)";
  const std::vector<double> x = Shown(text, {"time.output=0.001", "time.end=3.9995"})["n.command"];
  const std::vector<double> other = Shown(text, {"time.output=0.001", "time.end=3.9995", "integrator=rk4",
                                                 "integrator.step=0.0003", "loads.noise.seed=11"})["n.command"];
  EXPECT_EQ(x, other) << "steps change nothing";
  EXPECT_NE(x, Shown(text, {"time.output=0.001", "time.end=3.9995", "loads.noise.seed=12"})["n.command"]);
  double mean = 0, square = 0, beside = 0;
  for (std::size_t k = 1; k < x.size(); ++k) mean += x[k], square += x[k] * x[k], beside += x[k] * x[k - 1];
  const auto n = static_cast<double>(x.size() - 1);
  EXPECT_NEAR(mean / n, 0, 4 * 0.3 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(square / n), 0.3, 0.3 * 4 / std::sqrt(2 * n));
  EXPECT_NEAR(beside / n, 0, 4 * 0.09 / std::sqrt(n)) << "one sample says nothing of the next";
}

// Quotients of times and periods are rounded: 0.7/0.1 is less than 7.
TEST(Digital, NoiseIsDrawnAnewAtEverySample) {
  const std::vector<double> x = Shown(test::turntable + R"(outputs: {n: {type: control, of: noise, show: command}}
loads: {noise: {type: noise, deviation: 0.3, sample: 0.1}}
)",
                                      {"time.output=0.1", "time.end=10"})["n.command"];
  // The first and the last row are of their own samples, the others of those before.
  for (std::size_t k = 2; k + 1 < x.size(); ++k) EXPECT_NE(x[k], x[k - 1]) << k;
}

// At rest at −0.3 from the start on.
TEST(OverTime, MeansOfWhatRestsAreItFromTheFirstInstant) {
  const Shown s(test::turntable + R"(initial: {hinges: {axle: {position: [-0.3]}}}
loads:
  mean: {type: moving-average, of: axle, window: 0.05, sample: 0.01}
  size: {type: over-time, of: axle, what: rms}
outputs:
  mean_seen: {type: control, of: mean, show: command}
  size_seen: {type: control, of: size, show: command}
)",
                {"time.end=0.1"});
  for (const double mean : s["mean_seen.command"]) EXPECT_NEAR(mean, -0.3, 1e-15);
  for (const double size : s["size_seen.command"]) EXPECT_NEAR(size, 0.3, 1e-9);
}

TEST(Filter, AChainKeepsTheUnitOfWhatItMeasures) {
  const Shown s(test::turntable + R"(loads:
  smooth: {type: filter, of: axle.rate, cutoff: 20 Hz}
  mean: {type: over-time, of: smooth, what: mean}
  way: {type: over-time, of: smooth, what: integral}
outputs:
  mean_seen: {type: control, of: mean, show: command}
  way_seen: {type: control, of: way, show: command}
)");
  std::vector<std::string> units;
  for (const Column& column : s.columns) units.push_back(column.unit);
  EXPECT_EQ(units, (std::vector<std::string>{"rad/s", "(rad/s) s"}));
}

TEST(OverTime, SumsAreThoseOfAWave) {
  const Shown s(test::turntable + R"(outputs:
  area: {type: control, of: area, show: command}
  mean: {type: control, of: mean, show: command}
  rms: {type: control, of: rms, show: command}
loads:
  wave: {type: expression, value: 1 + 3 * sin(t), to: nothing}
  area: {type: over-time, of: wave, what: integral}
  mean: {type: over-time, of: wave, what: mean}
  rms: {type: over-time, of: wave, what: rms}
)",
                {"time.output=0.5", "time.end=7"});
  EXPECT_EQ(s["mean.command"][0], 1) << "over no time it is the signal";
  EXPECT_EQ(s["rms.command"][0], 1);
  for (std::size_t k = 1; k < s.times.size(); ++k) {
    const double t = s.times[k], area = t + 3 * (1 - std::cos(t));
    const double square = t + 6 * (1 - std::cos(t)) + 9 * (t / 2 - std::sin(2 * t) / 4);
    ASSERT_NEAR(s["area.command"][k], area, 1e-8);
    ASSERT_NEAR(s["mean.command"][k], area / t, 1e-8);
    ASSERT_NEAR(s["rms.command"][k], std::sqrt(square / t), 1e-8);
  }
}

/// Of a constant 2 from the first sample on, wherever between two of them it begins: no part of a period counts as a
/// whole one.
TEST(OverTime, ThatBeginsBetweenTwoSamplesBeginsAtTheNext) {
  const std::string text = test::turntable + R"(outputs:
  area: {type: control, of: area, show: command}
  mean: {type: control, of: mean, show: command}
  rms: {type: control, of: rms, show: command}
loads:
  area: {type: over-time, of: axle, what: integral, sample: 0.1}
  mean: {type: over-time, of: axle, what: mean, sample: 0.1}
  rms: {type: over-time, of: axle, what: rms, sample: 0.1}
)";
  const std::string rest = "hinges: {axle: {position: [2]}}";
  for (const std::vector<std::string>& begins :
       {std::vector<std::string>{"initial={" + rest + ", time: 0.29}"},
        {"initial={" + rest + ", time: 0.29999999999999}"},
        {"initial={" + rest + ", time: 0.3}"},
        {"initial={" + rest + R"(, settings: {area: "off", mean: "off", rms: "off"}})",
         "events={on: {at: 0.29, do: {switch_on: [area, mean, rms]}}}"}}) {
    std::vector<std::string> all = begins;
    all.emplace_back("time={end: 1.05, output: 0.05}");
    const Shown s(text, all);
    for (std::size_t k = 0; k < s.times.size(); ++k) {
      const double t = s.times[k];
      if (t < 0.32) continue;
      ASSERT_NEAR(s["mean.command"][k], 2, 1e-12) << begins.front() << ", " << t;
      ASSERT_NEAR(s["rms.command"][k], 2, 1e-12) << begins.front() << ", " << t;
      // A row at a sample shows what was held until then.
      const double sampled = std::ceil(t / 0.1 - 1e-6) - 1;
      ASSERT_NEAR(s["area.command"][k], 2 * 0.1 * (sampled - 3), 1e-12) << begins.front() << ", " << t;
    }
  }
}

// A mean that began at zero would jump at the start: the first stage of a fixed step would see another effort than all
// others do, an error of first order.
TEST(OverTime, MeansThatActDoNotJumpWhereTheyBegin) {
  for (const std::string what : {"mean", "rms"}) {
    const auto end = [&](const std::string& integrator) {
      const Shown s(
          test::turntable +
              "outputs: {seen: {type: hinge, hinge: axle}}\nloads:\n  past: {type: over-time, of: "
              "axle, what: " +
              what + "}\n  push: {type: expression, hinge: axle, value: -4 * past}\n",
          {"time.output=1", "time.end=1", "initial.hinges={axle: {position: [0.5]}}", "integrator=" + integrator});
      return s["seen.position"].back();
    };
    const double exact = end("{name: dop853, rtol: 1e-12, atol: 1e-14}");
    const double coarse = end("{name: rk4, step: 0.05}") - exact, fine = end("{name: rk4, step: 0.025}") - exact;
    EXPECT_LT(std::abs(coarse), 1e-3) << what;
    EXPECT_LT(std::abs(fine), std::abs(coarse) / 3.5) << what;
  }
}

/// Implicit stages that are guessed to stay at the start have a mean of zero there, however short the step: none of
/// them was solved until steps had been halved to where they moved nothing. A few steps are too long at any start.
TEST(OverTime, MeansThatActLetImplicitStepsBegin) {
  const Shown s(test::turntable + R"(outputs: {seen: {type: hinge, hinge: axle}}
loads:
  wave: {type: expression, value: cos(3 * t), to: nothing}
  past: {type: over-time, of: wave, what: mean}
  push: {type: expression, hinge: axle, value: -5 * past}
)",
                {"integrator=radau"});
  EXPECT_LE(s.scene.summary.steps.rejected, 4U);
}

TEST(ControlOutput, ShowsCommandErrorAndStates) {
  const Shown s(test::turntable + R"(outputs:
  c: {type: control, of: servo}
  d: {type: control, of: digital}
  axle_seen: {type: hinge, hinge: axle}
loads:
  servo: {type: pid, hinge: axle, proportional: 5, integral: 4, derivative: 1, filter: 0.05, reference: 0.5}
  digital: {type: pid, of: axle, to: nothing, proportional: 2, integral: 1, reference: 0.2, sample: 0.01}
)");
  const std::size_t rows = s.times.size();
  std::vector<std::string> names;
  for (const Column& c : s.columns) names.push_back(c.name + "[" + c.unit + "]");
  EXPECT_THAT(names, testing::ElementsAre("c.command[N m]", "c.error[rad]", "c.integral[N m]", "c.filter[rad]",
                                          "d.command[1]", "d.error[rad]", "d.integral[1]", "axle_seen.position[rad]",
                                          "axle_seen.rate[rad/s]", "axle_seen.acceleration[rad/s^2]"));
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double e = 0.5 - s["axle_seen.position"][k];
    ASSERT_DOUBLE_EQ(s["c.error"][k], e);
    // Of the last sample: a row shows what was held until its own, but for the first and the last.
    const std::size_t sampled = k > 0 && k + 1 < rows ? k - 1 : k;
    ASSERT_NEAR(s["d.error"][k], 0.2 - s["axle_seen.position"][sampled], 1e-12);
    ASSERT_NEAR(s["c.command"][k], 5 * e + s["c.integral"][k] + (e - s["c.filter"][k]) / 0.05, 1e-9);
    ASSERT_NEAR(s["c.command"][k], 0.2 * s["axle_seen.acceleration"][k], 1e-9);
  }
  EXPECT_THAT(test::problem_of(test::turntable + "outputs: {c: {type: control, of: servo, show: eror}}\nloads: {servo: "
                                                 "{type: pid, hinge: axle, proportional: 5}}\n"),
              HasSubstr("load 'servo' has no 'eror' to show; known: command, error"));
  EXPECT_THAT(test::problem_of(test::turntable + "outputs: {c: {type: control, of: spring}}\nloads: {spring: {type: "
                                                 "hinge-spring, hinge: axle, stiffness: 5}}\n"),
              HasSubstr("is no controller and has no limit"));
}

TEST(Schedule, GainsFollowTheirTablesOverASignal) {
  const Shown s(test::turntable + R"(outputs: {c: {type: control, of: servo}, axle_seen: {type: hinge, hinge: axle}}
loads:
  speed: {type: expression, value: 3 * t, to: nothing}
  servo: {type: pid, hinge: axle, reference: 0.5, schedule: speed, proportional: [[1, 4], [3, 10], [4, 2]], derivative: 0.5}
)");
  for (std::size_t k = 0; k < s.times.size(); ++k) {
    const double v = 3 * s.times[k];
    const double kp = v <= 1 ? 4 : v <= 3 ? 4 + 3 * (v - 1) : v <= 4 ? 10 - 8 * (v - 3) : 2;
    ASSERT_NEAR(s["c.command"][k], kp * s["c.error"][k] - 0.5 * s["axle_seen.rate"][k], 1e-12) << v;
  }
  const auto problem = [](const std::string& options) {
    return test::problem_of(test::turntable + "loads: {servo: {type: pid, hinge: axle, " + options + "}}\n");
  };
  EXPECT_THAT(problem("proportional: [[0, 1], [1, 2]]"),
              testing::AllOf(HasSubstr("/loads/servo/proportional"), HasSubstr("needs a 'schedule'")));
  EXPECT_THAT(problem("proportional: 3, schedule: axle"), HasSubstr("no gain is a table over it"));
  EXPECT_THAT(problem("proportional: [[0, 1], [1, 2]], schedule: axel"), HasSubstr("did you mean 'axle'"));
}

TEST(Digital, WhatBlocksLackIsSaid) {
  const auto problem = [](const std::string& options) {
    return test::problem_of(test::turntable + "loads: {block: {" + options + "}}\n");
  };
  EXPECT_THAT(problem("type: noise, deviation: 1"),
              HasSubstr("noise is of a digital measurement: it needs a 'sample'"));
  EXPECT_THAT(problem("type: filter, cutoff: 3"), HasSubstr("needs 'of' with one signal"));
  EXPECT_THAT(problem("type: filter, of: axle, cutoff: 3, order: 0"), HasSubstr("/loads/block/order"));
  EXPECT_THAT(problem("type: moving-average, of: axle, window: 0.015, sample: 0.01"),
              HasSubstr("needs 1 to 1000 times the 'sample'"));
  EXPECT_THAT(problem("type: over-time, of: axle, what: max"), HasSubstr("it needs a 'sample'"));
}

/// A force that jumps at a sample is read and shown as it is from then on, whichever of the two times, k T and that of
/// the row, is the earlier one by rounding, and with all integrators.
TEST(SampledMeasurement, OfAForceThatJumpsAtTheSampleIsOfWhatIsFromThenOn) {
  struct Instant {
    double sample;
    int multiple;
    double jump;
  };
  const Instant earlier{0.1, 3, 0.3}, later{0.009, 3, 0.027}, same{0.125, 2, 0.25};
  ASSERT_LT(earlier.jump, earlier.multiple * earlier.sample);
  ASSERT_GT(later.jump, later.multiple * later.sample);
  for (const char* integrator :
       {"dopri5", "dop853", "rk4-adaptive", "{name: rk4, step: 0.0037}", "radau", "{name: gauss, step: 0.0037}",
        "{name: generalized-alpha, step: 0.0037}", "imex", "rosenbrock-w", "cvode"}) {
    for (const Instant& at : {earlier, later, same}) {
      const Shown s(
          R"(
format: withy/1
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
outputs:
  imu: {type: accelerometer, of: cart}
  push: {type: effort, hinge: slide, of: jump}
  read: {type: control, of: felt, show: command}
  told: {type: control, of: known, show: command}
loads:
  jump: {type: hinge-effort, hinge: slide, law: steps, table: [[0, 1], [1, 9]]}
  felt: {type: expression, value: imu.x, to: nothing, sample: 1}
  known: {type: expression, value: push, to: nothing, sample: 1}
)",
          {std::string("integrator=") + integrator, "loads.jump.table.1.0=" + std::to_string(at.jump),
           "loads.felt.sample=" + std::to_string(at.sample), "loads.known.sample=" + std::to_string(at.sample),
           "time={end: " + std::to_string(at.jump + at.sample / 2) + ", output: " + std::to_string(at.sample) + "}"});
      EXPECT_DOUBLE_EQ(s["read.command"].back(), 4.5) << integrator << ", " << at.jump;
      EXPECT_DOUBLE_EQ(s["told.command"].back(), 9) << integrator << ", " << at.jump;
      EXPECT_DOUBLE_EQ(s["push"][static_cast<std::size_t>(at.multiple)], 9) << integrator << ", " << at.jump;
    }
  }
}

}  // namespace
}  // namespace withy
