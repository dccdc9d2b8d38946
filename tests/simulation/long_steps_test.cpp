// Where steps are as long as the motion allows, what happens within them is seen all the same: stops, switches, pulses,
// events and extremes of outputs, singular loops. Against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "withy/core/simulation/output_statistics.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/session.hpp"
#include "withy/core/simulation/step_parts.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::array integrators_with_estimates{"dopri5", "dop853",       "radau",       "imex",
                                                "cvode",  "rk4-adaptive", "rosenbrock-w"};

/// A kilogram on a slide, thrust back by a newton: x = 3 t − t²/2 from x = 0 while nothing else acts.
std::string thrown(const std::string& integrator, double end, const std::string& loads, const std::string& more = "") {
  return "format: withy/1\ntime: {end: " + std::to_string(end) + ", output: " + std::to_string(end) +
         "}\nintegrator: " + integrator +
         "\nbodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
         "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
         "initial: {hinges: {slide: {rate: [3]}}}\n"
         "loads:\n  back: {type: hinge-effort, hinge: slide, law: constant, value: -1}\n" +
         loads + more;
}

/// Where something is after `end` [s] that starts at x with v, falls back with `fall` [m/s²] and meets an elastic stop
/// of a stiffness by its mass [1/s²]: in small steps of its own.
double thrown_at_a_stop(double x, double v, double fall, double stop, double stiffness, double end) {
  constexpr double onset = 1e-3;
  constexpr int steps = 1600000;
  const auto acceleration = [&](double x) {
    const double depth = x - stop;
    if (depth <= 0) return -fall;
    return -fall - (depth < onset ? stiffness * depth * depth / (2 * onset) : stiffness * (depth - onset / 2));
  };
  const double h = end / steps;
  for (int i = 0; i < steps; ++i) {  // velocity Verlet
    v += h / 2 * acceleration(x);
    x += h * v;
    v += h / 2 * acceleration(x);
  }
  return x;
}

TEST(LongSteps, MeetAStopThatTheyWouldGoThroughAndComeBackFrom) {
  for (const double stop : {4.3, 4.4, 4.48}) {
    const double expected = thrown_at_a_stop(0, 3, 1, stop, 1e5, 8);
    for (const char* integrator : integrators_with_estimates) {
      test::LoadedScene s(thrown(std::string("{name: ") + integrator + "}", 8,
                                 "  stop: {type: hinge-limit, hinge: slide, upper: " + std::to_string(stop) +
                                     ", stiffness: 1e5, onset: 0.001}\n"));
      // Free flight ends at −8 m.
      EXPECT_NEAR(s.position(s.run().back(), "slide"), expected, 2e-3) << integrator << ", " << stop;
    }
  }
}

// Between dop853's stages there is one more for its interpolation alone: here it lies beyond the stop, and what is
// interpolated stays on this side.
TEST(LongSteps, MeetAStopThatBendsWhatIsInterpolatedWithinThem) {
  const double expected = thrown_at_a_stop(-0.5962154373914927, 1.3625531325001514, 9.81, -0.5025900021781403, 2e3, 1);
  for (const char* integrator : integrators_with_estimates) {
    test::LoadedScene s(
        std::string("format: withy/1\ntime: {end: 1, output: 1}\ngravity: [-9.81, 0, 0]\nintegrator: {name: ") +
        integrator +
        ", rtol: 1e-6, atol: 1e-9}\nbodies: {block: {type: rigid, mass: 5, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
        "initial: {hinges: {slide: {position: [-0.5962154373914927], rate: [1.3625531325001514]}}}\n"
        "loads: {stop: {type: hinge-limit, hinge: slide, upper: -0.5025900021781403, stiffness: 1e4, onset: 0.001}}\n");
    EXPECT_NEAR(s.position(s.run().back(), "slide"), expected, 1e-4) << integrator;
  }
}

/// Where it is after 20 s between relays of 10 N that fire beyond `on` and rest within 1 m: parabolas.
double between_relays(double on) {
  double t = 0, x = 0, v = 3, fired = 0;
  while (true) {
    const double a = -1 + fired;
    // The next time at which x + v s + a s²/2 is at what switches.
    double next = std::numeric_limits<double>::infinity();
    for (const double level : fired == 0 ? std::array{on, -on} : std::array{1.0, -1.0}) {
      if (fired != 0 && level * fired > 0) continue;  // a relay that pushes down rests once x is below 1
      const double root = v * v - 2 * a * (x - level);
      if (root < 0) continue;
      for (const double s : {(-v - std::sqrt(root)) / a, (-v + std::sqrt(root)) / a})
        if (s > 1e-9) next = std::min(next, s);
    }
    const double s = std::min(next, 20 - t);
    x += v * s + a * s * s / 2;
    v += a * s;
    t += s;
    if (t >= 20) return x;
    fired = fired != 0 ? 0 : x > 0 ? -10 : 10;
  }
}

TEST(LongSteps, SwitchARelayThatIsPassedForAWhile) {
  for (const double on : {4.4, 4.48}) {
    for (const char* integrator : integrators_with_estimates) {
      test::LoadedScene s(
          thrown(std::string("{name: ") + integrator + "}", 20,
                 "  relay: {type: hinge-relay, hinge: slide, effort: 10, on: " + std::to_string(on) + ", off: 1}\n"));
      // The default tolerance, 1e-6 of some 20 m, over some ten switchings.
      EXPECT_NEAR(s.position(s.run().back(), "slide"), between_relays(on), 1e-4) << integrator << ", " << on;
    }
  }
}

TEST(LongSteps, SeeAPulseInAFormulaOfTheTime) {
  const double impulse = 1000 * 0.02 * std::sqrt(std::numbers::pi);
  for (const char* integrator : integrators_with_estimates) {
    const std::string name = std::string("{name: ") + integrator + "}";
    test::LoadedScene load(
        thrown(name, 20, "  pulse: {type: expression, hinge: slide, value: 1000 * exp(-((t - 8) / 0.02) ^ 2)}\n"));
    EXPECT_NEAR(load.rate(load.run().back(), "slide"), 3 - 20 + impulse, 1e-3) << integrator;
    test::LoadedScene base(thrown(
        name, 20, "  shock: {type: base-excitation, formula: [1000 * exp(-((t - 8) / 0.02) ^ 2), \"0\", \"0\"]}\n"));
    EXPECT_NEAR(base.rate(base.run().back(), "slide"), 3 - 20 - impulse, 1e-3) << integrator;
  }
}

// A wide pulse lies between the stages of a step as a short one does, a small one beside a great one, and one that a
// difference of signals multiplies, and one in an output that the load measures.
TEST(LongSteps, SeePulsesOfAnyWidthAndHeightInAFormulaOfTheTime) {
  const double root_pi = std::sqrt(std::numbers::pi);
  const struct {
    const char* formula;
    double impulse;
  } pulses[] = {{"exp(-((t - 6.1) / 0.14) ^ 2)", 0.14 * root_pi},
                {"exp(-((t - 7.7) / 0.4) ^ 2)", 0.4 * root_pi},
                {"1000 * exp(-((t - 2) / 0.05) ^ 2) + 10 * exp(-((t - 5) / 0.05) ^ 2)", 1010 * 0.05 * root_pi},
                {"10 * exp(-((t - 5) / 0.05) ^ 2) * (other - slide.rate)", 5 * 0.05 * root_pi},
                {"gust", 0.05 * root_pi}};
  for (const char* integrator : integrators_with_estimates) {
    for (const auto& pulse : pulses) {
      const bool measures = std::string(pulse.formula).find("other") != std::string::npos;
      test::LoadedScene s(std::string("format: withy/1\ntime: {end: 10, output: 10}\nintegrator: ") + integrator +
                          R"(
bodies:
  block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  heavy: {type: rigid, mass: 1e9, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}
  other: {type: prismatic, axis: [1, 0, 0], parent: world, child: heavy}
initial: {hinges: {other: {position: [0.5]}}}
outputs: {gust: {type: expression, value: exp(-((t - 3) / 0.05) ^ 2), unit: N}}
loads: {pulse: {type: expression, hinge: slide, value: ")" +
                          std::string(pulse.formula) + "\"}}\n");
      // Of the last one v' = 10 g(t) (0.5 − v).
      const double expected = measures ? 0.5 * (1 - std::exp(-2 * pulse.impulse)) : pulse.impulse;
      EXPECT_NEAR(s.rate(s.run().back(), "slide"), expected, 1e-4 * expected) << integrator << pulse.formula;
    }
  }
}

// A host steps as far as it likes: formulas are looked at over the span of the scene, wherever it has gone on from.
TEST(LongSteps, OfAHostSeeAPulseInAFormulaOfTheTime) {
  test::LoadedScene s(
      "format: withy/1\ntime: {end: 10}\n"
      "bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
      "loads: {pulse: {type: expression, hinge: slide, value: "
      "\"exp(-((t - 5) / 0.05) ^ 2) + exp(-((t - 17) / 0.05) ^ 2)\"}}\n");
  const auto session = [&] {
    SessionOptions options;
    options.looks_over = span_of(s.scene);
    return Session(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options);
  };
  const double impulse = 0.05 * std::sqrt(std::numbers::pi);
  Session whole = session();
  ASSERT_TRUE(whole.advance(10, false).reached);
  EXPECT_NEAR(s.rate(whole.state(), "slide"), impulse, 1e-4 * impulse);
  const Checkpoint there = whole.snapshot();
  ASSERT_TRUE(whole.advance(25, false).reached);
  EXPECT_NEAR(s.rate(whole.state(), "slide"), 2 * impulse, 1e-4 * impulse);
  Session rest = session();
  rest.restore(there);
  ASSERT_TRUE(rest.advance(25, false).reached);
  EXPECT_EQ(rest.state().y, whole.state().y);
}

TEST(LongSteps, AreNotLookedIntoForAWheelThatNothingWatchedDependsOn) {
  test::LoadedScene s(
      "format: withy/1\ntime: {end: 100}\n"
      "bodies: {hull: {type: rigid, mass: 9, inertia: [1, 1, 1, 0, 0, 0]}, wheel: {type: rigid, mass: 1, inertia: "
      "[0.1, 0.1, 0.1, 0, 0, 0]}}\n"
      "hinges:\n  yaw: {type: revolute, axis: [0, 0, 1], parent: world, child: hull}\n"
      "  spin: {type: revolute, axis: [0, 0, 1], parent: hull, child: wheel}\n"
      "initial: {hinges: {spin: {rate: [600]}}}\n");
  const std::vector<double>& y = s.scene.initial.y;
  const auto sees = [&](const std::string& hinge) {
    return [at = s.hinge(hinge).position](std::size_t coordinate) { return coordinate == at; };
  };
  StepParts all(*s.scene.model, 0, 100), of_hull = all, of_wheel = all;
  of_hull.leave_out(sees("yaw"));
  of_wheel.leave_out(sees("spin"));
  EXPECT_EQ(all(0.1, y, y), 120u) << "60 radians";
  EXPECT_EQ(of_hull(0.1, y, y), 1u);
  EXPECT_EQ(of_wheel(0.1, y, y), 120u);
}

// At the start the slider is on the axle, where the wheel's angle matters to nothing watched. It moves out as
// 0.01 (t − 0.5) m and passes x = 0.1 m upwards once a turn from t = 10.5 s on, in the last 9.5 s.
TEST(LongSteps, AreLookedIntoForAWheelThatComesToMatter) {
  test::LoadedScene s(
      "format: withy/1\ngravity: [0, 0, 0]\ntime: {end: 20}\n"
      "bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}, slider: {type: rigid, mass: 1e-9, inertia: "
      "[1, 1, 1, 0, 0, 0]}}\n"
      "hinges:\n  spin: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}\n"
      "  out: {type: prismatic, axis: [1, 0, 0], parent: wheel, child: slider}\n"
      "motions: {move: {type: spin-up, hinge: out, rate: 0.01, duration: 1}}\n"
      "initial: {hinges: {spin: {rate: [30]}}}\n"
      "outputs: {f: {type: frame, of: slider, show: position}}\n"
      "events: {up: {signal: f.x, value: 0.1, direction: up}}\n");
  s.run();
  EXPECT_NEAR(static_cast<double>(s.summary.events.size()), 9.5 * 30 / (2 * std::numbers::pi), 1);
}

// A sampled load makes steps end where the hinge comes to 0.3 rad to the last bit: the side it came from is kept.
TEST(LongSteps, MeetAnEventWhoseValueIsThatAtASampleToTheLastBit) {
  test::LoadedScene s(
      "format: withy/1\ngravity: [0, 0, 0]\ntime: {end: 1, output: 1}\n"
      "bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}, b: {type: rigid, mass: 1, inertia: [1, 1, 1, "
      "0, "
      "0, 0]}}\n"
      "hinges:\n  ha: {type: revolute, axis: [0, 0, 1], parent: world, child: a}\n"
      "  hb: {type: revolute, axis: [0, 0, 1], parent: world, child: b}\n"
      "motions: {m: {type: constant-rate, hinge: ha, rate: 1}}\n"
      "loads: {p: {type: pid, hinge: hb, proportional: 1, reference: 0.1, sample: 0.1}}\n"
      "events: {third: {hinge: ha, value: 0.3}, half: {hinge: ha, value: 0.5}}\n");
  s.run();
  ASSERT_EQ(s.summary.events.size(), 2U);
  EXPECT_NEAR(s.summary.events[0].time, 0.3, 1e-12);
  EXPECT_NEAR(s.summary.events[1].time, 0.5, 1e-12);
}

// On a spring of 1 N/m the block follows the ramp, x = t, until the pulse of the impulse √π a w, which leaves
// √π a w exp(−w²/4) sin(t − t₀).
TEST(LongSteps, SeeAPulseBesideWhatGoesOnChanging) {
  constexpr double a = 5, w = 0.15, at = 50.7;
  for (const char* integrator : {"dopri5", "dop853", "radau", "cvode"}) {
    test::LoadedScene s(
        std::string("format: withy/1\ntime: {end: 100, output: 100}\nintegrator: {name: ") + integrator +
        ", rtol: 1e-8}\n"
        "bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
        "initial: {hinges: {slide: {rate: [1]}}}\n"
        "loads: {k: {type: hinge-spring, hinge: slide, stiffness: 1}, f: {type: expression, hinge: slide, value: "
        "\"t + 5*exp(-((t-50.7)/0.15)^2)\"}}\n");
    const double left = std::sqrt(std::numbers::pi) * a * w * std::exp(-w * w / 4) * std::sin(100 - at);
    EXPECT_NEAR(s.position(s.run().back(), "slide"), 100 + left, 1e-3) << integrator;
  }
}

// x is 50 m at the pulse: what a threshold of a signal lets through of it. Its impulse is √π w ∫(x − 10) of 40 N s, to
// the motion within the pulse.
TEST(LongSteps, SeeAPulseBehindAThresholdOfASignal) {
  const auto end = [](const std::string& integrator) {
    test::LoadedScene s("format: withy/1\ntime: {end: 100, output: 100}\nintegrator: " + integrator +
                        "\nbodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
                        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
                        "initial: {hinges: {slide: {rate: [1]}}}\n"
                        "loads: {f: {type: expression, hinge: slide, value: "
                        "\"max(0, slide - 10)*exp(-((t-50.3)/0.15)^2)\"}}\n");
    return s.rate(s.run().back(), "slide");
  };
  const double closely = end("{name: dopri5, rtol: 1e-9, max_step: 0.05}");
  EXPECT_GT(closely, 10);
  EXPECT_NEAR(end("{name: dopri5, rtol: 1e-9}"), closely, 1e-6 * closely);
}

// What controllers are to follow is a formula of the time too, and so is a shaped motion of one: the wheel swings about
// the reference as one that was looked at closely.
TEST(LongSteps, SeeAPulseInAFormulaThatIsFollowed) {
  const std::string formula = "{type: expression, value: \"exp(-((t-50.3)/0.2)^2)\"}";
  for (const std::string& loads :
       {"loads: {c: {type: pd-controller, law: motion, hinges: {x: {stiffness: 1, damping: 0.02, motion: " + formula +
            "}}}}\n",
        "loads: {c: {type: pid, hinge: x, proportional: 1, motion: " + formula + "}}\n",
        "motions: {m: {type: shaped, hinge: y, motion: " + formula +
            ", modes: [[0.5, 0]]}}\nloads: {k: {type: hinge-spring, hinge: x, stiffness: 1}}\n"}) {
    const auto end = [&](const std::string& integrator) {
      test::LoadedScene s("format: withy/1\ntime: {end: 100, output: 100}\nintegrator: " + integrator +
                          "\nbodies:\n  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  b: {type: rigid, "
                          "mass: 1, inertia: [1, "
                          "1, 1, 0, 0, 0]}\n"
                          "hinges:\n  y: {type: revolute, axis: [1, 0, 0], parent: world, child: b}\n  x: {type: "
                          "revolute, axis: [1, 0, "
                          "0], parent: b, child: a}\n" +
                          loads);
      return s.run().back();
    };
    const State closely = end("{name: dopri5, rtol: 1e-9, max_step: 0.05}"), freely = end("{name: dopri5, rtol: 1e-9}");
    double most = 0;
    for (std::size_t i = 0; i < freely.y.size(); ++i) {
      most = std::max(most, std::abs(closely.y[i]));
      EXPECT_NEAR(freely.y[i], closely.y[i], 1e-5) << loads;
    }
    EXPECT_GT(most, 0.01) << loads;
  }
}

// A formula that changes all along is met wherever steps end: their errors rule, as without it.
TEST(LongSteps, AreNotCutByARippleOfAFormulaThatHardlyActs) {
  const auto steps = [](const std::string& value) {
    test::LoadedScene s(
        "format: withy/1\ntime: {end: 20, output: 20}\nintegrator: dop853\n"
        "bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}\n"
        "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}\n"
        "initial: {hinges: {slide: {position: [1]}}}\n"
        "loads: {spring: {type: expression, hinge: slide, value: " +
        value + "}}\n");
    s.run();
    return s.summary.steps.accepted;
  };
  // Until they have seen it: 16 times its scale, and as many beside.
  EXPECT_LE(steps("\"-slide + 1e-10 * sin(300 * t)\""), steps("\"-slide\"") + 48);
}

/// A rotor that turns freely at 50 rad/s, a place on it, and an event as it comes by.
std::string rotor(const std::string& integrator) {
  return "format: withy/1\ntime: {end: 20, output: 20}\nintegrator: {name: " + integrator + R"(}
bodies: {rotor: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0], frames: {rim: {position: [1, 0, 0]}}}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: rotor}}
initial: {hinges: {axle: {rate: [50]}}}
outputs: {rim: {type: frame, of: rotor.rim, show: position, statistics: true}}
events: {by: {signal: rim.y, value: 0.9, direction: up}}
)";
}

TEST(LongSteps, OfAFreeRotorHaveItsEventsAndStatistics) {
  for (const char* integrator : integrators_with_estimates) {
    test::LoadedScene s(rotor(integrator));
    RunOptions options;
    options.end = options.output = 20;
    options.events = s.scene.events;
    StatisticsWatch watch(s.scene.outputs, {"rim"}, *s.equations, discontinuities(*s.scene.model),
                          StepParts(*s.scene.model, 0, 20));
    const RunSummary summary =
        simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {}, &watch);
    ASSERT_EQ(summary.status, RunStatus::completed) << summary.message;
    // sin(50 t) passes 0.9 at arcsin 0.9 in each of 1000/2π turns.
    EXPECT_EQ(summary.events.size(), 159U) << integrator;
    const OutputStatistics& x = watch.results().front();
    ASSERT_EQ(x.name, "rim.x");
    EXPECT_NEAR(x.integral, std::sin(1000) / 50, 1e-6) << integrator;
    EXPECT_NEAR(x.rms(), std::sqrt(0.5 + std::sin(2000) / 4000), 1e-5) << integrator;
    EXPECT_NEAR(x.greatest, 1, 1e-9) << integrator;
    EXPECT_NEAR(x.least, -1, 1e-9) << integrator;
  }
}

TEST(LongSteps, ThatAreGivenAreToldWhereTheirEnergyBalancesAllTheSame) {
  const auto run = [](const std::string& step) {
    test::LoadedScene s("format: withy/1\ntime: {end: 20, output: 20}\nintegrator: {name: gauss, step: " + step + R"(}
bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
initial: {hinges: {slide: {position: [0.123], rate: [3]}}}
loads: {stops: {type: hinge-limit, hinge: slide, lower: -1, upper: 1, stiffness: 1e5, onset: 0.001}}
)");
    s.run();
    return s.summary;
  };
  // A contact lasts π/√(k/m), 0.01 s.
  const RunSummary coarse = run("0.01"), fine = run("0.0005");
  EXPECT_LT(coarse.energy_drift, 1e-9);
  EXPECT_THAT(coarse.message, HasSubstr("is too long for what acts"));
  EXPECT_THAT(fine.message, Not(HasSubstr("is too long for what acts")));
}

TEST(LongSteps, ThatGrowWithoutEndAreNotTrustedWhereTheirErrorPassesThroughZero) {
  // cos t in steps of RK4 beyond 2√2, to which it is stable.
  test::LoadedScene s(R"(format: withy/1
time: {end: 3000, output: 3000}
integrator: {name: rk4, step: 2.84}
bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 1}}
initial: {hinges: {slide: {position: [1]}}}
)");
  RunOptions options;
  options.end = options.output = 3000;
  options.drift_limit = 0.01;
  const RunSummary summary = simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {});
  EXPECT_EQ(summary.status, RunStatus::inaccurate);
  EXPECT_LT(std::abs(s.position(summary.final, "slide")), 1.01) << summary.message;
}

TEST(LongSteps, OfARunWithoutAnEndReachThatOfWhatAnEventSets) {
  test::LoadedScene s(R"(format: withy/1
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {block: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
initial: {hinges: {slide: {rate: [0.3]}}}
loads: {jet: {type: thruster, frame: block, thrust: 5, direction: [1, 0, 0], firings: [[1, 2]]}}
events: {later: {at: 0.5, do: {set: "loads.jet.firings=[[3,4]]"}}}
)");
  EXPECT_EQ(end_of_run(s.scene), 4);
}

}  // namespace
}  // namespace withy
