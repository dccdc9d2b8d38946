// Prescribed motions of hinges: their laws, what driven beams do, the efforts that motions need, and what is refused.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/motion_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<Motion> motion(const char* id, std::vector<Value::Member> given) {
  Registry registry = load_registry();
  return make_plugin<Motion>(registry, id, std::move(given));
}

TEST(MotionLaws, conform) {
  expect_motion_conforms(*motion("locked", {}));
  expect_motion_conforms(*motion("constant-rate", {{"rate", Value(2.0)}, {"from", Value(0.3)}}));
  expect_motion_conforms(*motion("spin-up", {{"rate", Value(6.0)}, {"duration", Value(1.5)}}));
  expect_motion_conforms(*motion("quintic", {{"to", Value(1.0)}, {"from", Value(-1.0)}, {"duration", Value(0.7)}}));
  expect_motion_conforms(*motion("sine", {{"amplitude", Value(0.5)}, {"period", Value(0.8)}, {"phase", Value(0.2)}}));
  expect_motion_conforms(
      *motion("table", {{"table", Value::list({list_of({0, 1}), list_of({0.5, 2}), list_of({0.9, -1})})}}));
}

// Between two rows the cubic that has the rates given there, (x₀ + x₁)/2 + (v₀ − v₁) T/8 in the middle; beyond them
// straight lines.
TEST(MotionLaws, of_tables_have_the_rates_of_their_ends) {
  const auto law = motion("table", {{"table", Value::list({list_of({0, 1}), list_of({2, 4})})},
                                    {"start_rate", Value(2.0)},
                                    {"end_rate", Value(-1.0)}});
  EXPECT_NEAR(law->at(1).position, 2.5 + 3 * 2.0 / 8, 1e-14);
  EXPECT_NEAR(law->at(3).position, 3, 1e-14);
  EXPECT_NEAR(law->at(3).rate, -1, 1e-14);
  EXPECT_NEAR(law->at(-1).position, -1, 1e-14);
  EXPECT_NEAR(law->at(-1).rate, 2, 1e-14);
}

TEST(MotionLaws, of_formulas_have_exact_derivatives) {
  const auto law = [](const char* text) { return motion("expression", {{"value", Value(std::string(text))}}); };
  expect_motion_conforms(*law("0.3 * sin(5*t)^2 / (2 + cos(t)) - atan(t^3) + sqrt(1 + t^2) - (-t)^2"));
  expect_motion_conforms(*law("exp(-t^2) * log(4 + t) + tan(0.3*t) + atan2(1 + sin(t), 2 - t) + norm(t, 1, cos(3*t))"));
  expect_motion_conforms(*law("2^(0.5*t) + (1.5 + sin(t))^cos(t) + max(4 + t, 1) - min(-9, t) + abs(8 + t)"));
  const MotionPoint p = law("0.2 * (1 - cos(3 * t))")->at(0.7);
  EXPECT_DOUBLE_EQ(p.position, 0.2 * (1 - std::cos(2.1)));
  EXPECT_DOUBLE_EQ(p.rate, 0.6 * std::sin(2.1));
  EXPECT_NEAR(p.acceleration, 1.8 * std::cos(2.1), 1e-14);
  EXPECT_EQ(law("t^2")->at(0).acceleration, 2);
  EXPECT_THAT(problem_of(turntable + "motions: {m: {type: expression, hinge: axle, value: 2 * axle}}\n"),
              HasSubstr("there is nothing called 'axle'"));
  EXPECT_THAT(problem_of(turntable + "motions: {m: {type: expression, hinge: axle, value: sqrt(t - 1)}}\n"),
              HasSubstr("/motions/m: has no finite coordinate and rate at 0 s"));
}

/// At a constant rate the work is all that a method's error control can see: that of the weight, m g c sin θ.
TEST(DrivenHinge, has_its_work_to_the_tolerance_with_every_method) {
  for (const char* method : {"dopri5", "dop853", "rk4-adaptive", "radau"}) {
    LoadedScene s("format: withy/1\ngravity: [0, -9.81, 0]\ntime: {end: 2}\nintegrator: {name: " + std::string(method) +
                  R"(, rtol: 1e-7, atol: 1e-9}
bodies: {arm: {type: rigid, mass: 2, center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}}
motions: {turn: {type: constant-rate, hinge: axle, rate: 5}}
)");
    EXPECT_NEAR(s.run().back().y.back(), 9.81 * std::sin(10), 1e-5) << method;
  }
}

/// Up to there the run is kept; the mass matrix is not said to be the reason.
TEST(DrivenHinge, ends_where_its_motion_does_and_names_it) {
  LoadedScene s(turntable + "motions: {turn: {type: expression, hinge: axle, value: sqrt(1-t)*sin(t)}}\n");
  RunOptions options;
  options.end = 2;
  const RunSummary run = simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options,
                                  [&](const State& state) { EXPECT_TRUE(std::isfinite(s.rate(state, "axle"))); });
  EXPECT_EQ(run.status, RunStatus::diverged);
  EXPECT_THAT(run.message, HasSubstr("motion 'turn' has no finite coordinate at t = 1 s"));
  EXPECT_THAT(run.message, testing::Not(HasSubstr("mass matrix")));
  EXPECT_NEAR(run.reached, 1, 1e-6);
}

/// Theory, section 6, taken literally.
TEST(MotionLaws, spin_up_is_that_of_the_benchmark) {
  const auto law = motion("spin-up", {{"rate", Value(6.0)}, {"duration", Value(15.0)}});
  const double T = 15, w = 6, pi = std::numbers::pi;
  for (const double t : {0.0, 1e-3, 2.0, 7.5, 14.9, 15.0}) {
    const double x = w / T * (t * t / 2 + std::pow(T / (2 * pi), 2) * (std::cos(2 * pi * t / T) - 1));
    EXPECT_NEAR(law->at(t).position, x, 1e-13 * (1 + x)) << t;
  }
  EXPECT_DOUBLE_EQ(law->at(20).position, 6 * (20 - 7.5));
  EXPECT_EQ(law->at(20).rate, 6);
  EXPECT_EQ(law->at(-1).position, 0);
  EXPECT_EQ(law->end(), 15);
}

/// A beam clamped to a hub whose hinge a motion drives; 6 clamped-free modes.
std::string spin_up(double length, double stiffness, double mass, double rate, const std::string& formulation) {
  return "format: withy/1\nformulation: " + formulation +
         "\nintegrator: {name: dopri5, rtol: 1e-7, atol: 1e-9}\ntime: {end: 15, output: 0.01}\nbodies:\n"
         "  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  blade: {type: beam, length: " +
         std::to_string(length) + ", mass_per_length: " + std::to_string(mass) +
         ", bending_y: {stiffness: " + std::to_string(stiffness) +
         ", modes: 6, family: clamped-free}}\n"
         "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
         "  root: {type: weld, parent: hub, child: blade}\n"
         "motions: {spin: {type: spin-up, hinge: axle, rate: " +
         std::to_string(rate) + ", duration: 15}}\n";
}

struct SpinUp {
  double length, stiffness, mass, rate;
  std::vector<std::pair<const char*, double>> peaks;
  bool inconsistent_diverges;
  double peak_time;  ///< in `consistent`
};
void PrintTo(const SpinUp& s, std::ostream* out) { *out << s.length << " m to " << s.rate << " rad/s"; }

/// The table of theory section 6, from an independent brute-force program: tip deflections in the root frame, 6 modes.
const SpinUp benchmark[] = {
    {10,
     1.4e4,
     1.2,
     6,
     {{"consistent", 0.57437}, {"ruthless", 0.62916}, {"quadratic", 0.57584}, {"exact", 0.57375}},
     true,
     6.76},
    {8,
     566.66,
     0.20188,
     2,
     {{"consistent", 0.28027},
      {"inconsistent", 0.34320},
      {"ruthless", 0.28570},
      {"quadratic", 0.28049},
      {"exact", 0.28014}},
     false,
     7.02},
    {8,
     566.66,
     0.20188,
     4,
     {{"consistent", 0.53445}, {"ruthless", 0.57140}, {"quadratic", 0.53626}, {"exact", 0.53363}},
     true,
     6.77}};

class SpinUpBenchmark : public testing::TestWithParam<SpinUp> {};

TEST_P(SpinUpBenchmark, peaks_are_those_of_the_table) {
  const SpinUp& c = GetParam();
  for (const auto& [formulation, peak] : c.peaks) {
    LoadedScene s(spin_up(c.length, c.stiffness, c.mass, c.rate, formulation));
    const auto states = s.run();
    EXPECT_NEAR(s.summary.peak_deflection["blade"][1], peak, 2e-4 * peak) << formulation;
    if (std::string(formulation) != "consistent") continue;
    double time = 0, lowest = 0;
    const int tip = s.scene.model->bodies()[1].frame("tip");
    for (const State& state : states) {
      const double y = s.equations->deflection(state.y, 1, tip)[1];
      if (y < lowest) {
        lowest = y;
        time = state.time;
      }
    }
    EXPECT_NEAR(lowest, -peak, 2e-4 * peak);
    EXPECT_NEAR(time, c.peak_time, 0.0051);  // the table gives hundredths
  }
}

TEST_P(SpinUpBenchmark, inconsistent_equations_diverge_where_the_table_says) {
  const SpinUp& c = GetParam();
  LoadedScene s(spin_up(c.length, c.stiffness, c.mass, c.rate, "inconsistent"));
  RunOptions options;
  options.end = 15;
  const RunSummary run = simulate(*s.scene.model, *s.equations, *s.scene.integrator, s.scene.initial, options, {});
  EXPECT_EQ(run.status == RunStatus::completed, !c.inconsistent_diverges) << run.message;
}

INSTANTIATE_TEST_SUITE_P(Cases, SpinUpBenchmark, testing::ValuesIn(benchmark),
                         [](const auto& of) { return "case" + std::to_string(of.index + 1); });

/// The driven coordinate is integrated like any other and stays on its law; the work of the motion is the energy.
TEST(DrivenHinge, stays_on_its_law_and_its_work_is_the_energy) {
  LoadedScene s(spin_up(8, 566.66, 0.20188, 4, "quadratic"));
  const auto law = motion("spin-up", {{"rate", Value(4.0)}, {"duration", Value(15.0)}});
  for (const State& state : s.run()) {
    EXPECT_NEAR(s.position(state, "axle"), law->at(state.time).position, 1e-6);
    EXPECT_NEAR(s.rate(state, "axle"), law->at(state.time).rate, 1e-6);
  }
  EXPECT_LT(s.summary.energy_drift, 1e-6);
  EXPECT_GT(s.summary.final.y.back(), 100);
}

/// A rod of inertia J about its hinge under gravity: effort = J ẍ + m g l cos x.
TEST(DrivenHinge, needs_the_effort_of_inverse_dynamics) {
  LoadedScene s(
      "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {end: 2, output: 0.1}\nbodies:\n  rod: {type: rigid, mass: 3, "
      "center_of_mass: [0.5, 0, 0], inertia: [0.1, 0.2, 0.25, 0, 0, 0]}\nhinges: {pin: {type: revolute, axis: [0, 0, "
      "1], "
      "parent: world, child: rod}}\nloads: {help: {type: hinge-effort, hinge: pin, law: constant, value: 4}}\n"
      "motions: {swing: {type: sine, hinge: pin, amplitude: 0.8, period: 1.5, phase: 0.3}}\n");
  const auto law = motion("sine", {{"amplitude", Value(0.8)}, {"period", Value(1.5)}, {"phase", Value(0.3)}});
  Work work = s.equations->make_work();
  double peak = 0;
  for (const State& state : s.run()) {
    const MotionPoint p = law->at(state.time);
    const double needed = (0.25 + 3 * 0.25) * p.acceleration + 3 * 9.81 * 0.5 * std::cos(p.position) - 4;
    std::vector<double> effort(1);
    ASSERT_TRUE(s.equations->motion_efforts(state.time, state.y, effort, work).ok());
    EXPECT_NEAR(effort[0], needed, 1e-4);
    peak = std::max(peak, std::abs(needed));
  }
  EXPECT_GE(s.summary.peak_motion_effort[0], peak - 1e-4);
  EXPECT_LT(s.summary.peak_motion_effort[0], peak + 1);
  EXPECT_LT(s.summary.energy_drift, 1e-5);  // at the integrator's default tolerance, 1e-6
}

/// With every hinge but one locked the tree moves as if these were welds.
TEST(LockedHinge, is_a_weld) {
  const auto text = [](const char* lock) {
    return std::string(
               "format: withy/1\ngravity: [0, 0, -9.81]\ntime: {end: 1, output: 0.1}\nintegrator: {name: dopri5, rtol: "
               "1e-9, atol: 1e-11}\nbodies:\n"
               "  a: {type: rigid, mass: 1, center_of_mass: [0.3, 0, 0], inertia: [.1, .2, .3, 0, 0, 0], frames: {end: "
               "{position: [0.6, 0, 0]}}}\n"
               "  b: {type: beam, length: 1, mass_per_length: 0.8, bending_y: {stiffness: 20, modes: 2, family: "
               "clamped-free}, bending_z: {stiffness: 30, modes: 2, family: clamped-free}}\n"
               "  c: {type: rigid, mass: 0.5, inertia: [.1, .1, .1, 0, 0, 0], center_of_mass: [0.2, 0.1, 0]}\n"
               "hinges:\n  base: {type: revolute, axis: [0, 1, 0], parent: world, child: a}\n") +
           (lock[0] != '\0'
                ? "  joint: {type: spherical, parent: a.end, child: b}\n  slide: {type: prismatic, axis: [1, "
                  "0, 0], parent: b.tip, child: c}\nmotions: {hold: {type: locked, hinge: joint}, still: "
                  "{type: locked, hinge: slide}}\n"
                : "  joint: {type: weld, parent: a.end, child: b}\n  slide: {type: weld, parent: b.tip, "
                  "child: c}\n");
  };
  LoadedScene locked(text("locked")), welded(text(""));
  const auto one = locked.run(), other = welded.run();
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(locked.position(one[i], "base"), welded.position(other[i], "base"), 1e-8);
    const auto tip = [&](const LoadedScene& s, const State& state) {
      const auto p = s.equations->frame_pose(state.y, 2, 0).position;
      return Vector3(p[0], p[1], p[2]);
    };
    EXPECT_LT((tip(locked, one[i]) - tip(welded, other[i])).norm(), 1e-8);
    EXPECT_EQ(locked.position(one[i], "slide"), 0);
  }
}

TEST(LockedHinge, stays_where_the_scene_puts_it) {
  LoadedScene s(shipped("spacecraft.yaml") +
                    "\nmotions: {a: {type: locked, hinge: right_hinge}, b: {type: locked, hinge: "
                    "left_drive}}\n",
                {"time.end=0.5", "initial.hinges.left_drive.rate=[0]"});
  const auto states = s.run();
  EXPECT_EQ(s.position(states.back(), "right_hinge"), s.position(states.front(), "right_hinge"));
  EXPECT_NEAR(s.position(states.back(), "right_hinge"), -15 * std::numbers::pi / 180, 1e-15);
  EXPECT_LT(s.summary.energy_drift, 1e-6);
}

/// Restarted from the state that a run has left, the motion goes on.
TEST(DrivenHinge, begins_where_its_motion_is_and_restarts_there) {
  const std::string text =
      "format: withy/1\ntime: {end: 1, output: 0.1}\nbodies: {rod: {type: rigid, mass: 3, inertia: [1, 1, 1, 0, 0, "
      "0]}}\n"
      "hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}}\nmotions: {swing: {type: sine, "
      "hinge: "
      "pin, amplitude: 0.8, period: 1.5, phase: 0.3}}\n";
  LoadedScene s(text);
  EXPECT_DOUBLE_EQ(s.position(s.scene.initial, "pin"), 0.8 * std::sin(0.3));
  const State half = s.run()[5];
  LoadedScene again(text + "initial: " + write_state(*s.scene.model, half) + "\n");
  EXPECT_DOUBLE_EQ(again.position(again.scene.initial, "pin"), 0.8 * std::sin(2 * std::numbers::pi * 0.5 / 1.5 + 0.3));
  // A state for an evaluation takes what it says; what it leaves out comes from the motion at its time.
  const State later = parse_state(R"({"time": 0.5})", "state", *s.scene.model, s.scene.initial);
  EXPECT_DOUBLE_EQ(later.y[0], again.scene.initial.y[0]);
}

TEST(Motions, say_what_is_wrong_with_them) {
  const auto problem = [](const std::string& motions, const std::string& more = "") {
    return problem_of(
        "format: withy/1\ntime: {end: 1}\nbodies:\n  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  b: "
        "{type: "
        "rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  c: {type: rigid, mass: 1}\nhinges:\n  pin: {type: revolute, "
        "axis: "
        "[0, 0, 1], parent: world, child: a}\n  ball: {type: spherical, parent: a, child: b}\n  glue: {type: weld, "
        "parent: b, child: c}\nmotions: {" +
        motions + "}\n" + more);
  };
  EXPECT_EQ(problem("x: {type: locked, hinge: ball}"), "");
  EXPECT_THAT(problem("x: {type: locked, hinge: bal}"), HasSubstr("did you mean 'ball'?"));
  EXPECT_THAT(problem("x: {type: spin, hinge: pin}"), HasSubstr("/motions/x/type"));
  EXPECT_THAT(problem("x: {type: constant-rate, hinge: ball, rate: 1}"), HasSubstr("hinge 'ball' has 3 rates"));
  EXPECT_THAT(problem("x: {type: locked, hinge: glue}"), HasSubstr("hinge 'glue' does not move"));
  EXPECT_THAT(problem("x: {type: locked, hinge: pin}, y: {type: constant-rate, hinge: pin, rate: 1}"),
              HasSubstr("driven by motion 'x' already"));
  EXPECT_THAT(problem("x: {type: constant-rate, hinge: pin, rate: 2}", "initial: {hinges: {pin: {rate: [1]}}}\n"),
              HasSubstr("/initial/hinges/pin/rate: got 1, but motion 'x' has the hinge at 2 at 0 s"));
  EXPECT_THAT(
      problem("x: {type: constant-rate, hinge: pin, rate: 2, from: 1}", "initial: {hinges: {pin: {position: [0]}}}\n"),
      HasSubstr("/initial/hinges/pin/position"));
  EXPECT_THAT(problem("x: {type: locked, hinge: pin}", "initial: {hinges: {pin: {position: [1], rate: [3]}}}\n"),
              HasSubstr("/initial/hinges/pin/rate"));
  EXPECT_EQ(problem("x: {type: locked, hinge: pin}", "initial: {hinges: {pin: {position: [1]}}}\n"), "");
  EXPECT_THAT(problem("x: {type: table, hinge: pin, table: []}"), HasSubstr("/motions/x/table"));
  EXPECT_THAT(problem("x: {type: table, hinge: pin, table: [[0.5, 0.3]], start_rate: 1, end_rate: 2}"),
              HasSubstr("has one row, where the rate would jump"));
}

}  // namespace
}  // namespace withy::test
