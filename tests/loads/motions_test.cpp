// Prescribed motions of hinges: their laws, what driven beams do, the efforts that motions need, and what is refused.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "withy/core/simulation/session.hpp"
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

/// Rotating cantilever, hub radius 0 (Wright et al. 1982 and others; theory section 6): eigenvalues of the dense system
/// at constant rate about the straight blade, a steady state. flap across the plane of rotation, lag in it:
/// lag² = flap² − η².
struct Rotating {
  double eta, flap1, flap2;
};
const Rotating rotating[] = {{0, 3.51602, 22.03449},  {1, 3.68165, 22.18101}, {2, 4.13732, 22.61492},
                             {4, 5.58500, 24.27335},  {6, 7.36037, 26.80908}, {10, 11.20233, 33.64037},
                             {12, 13.17015, 37.60311}};

/// Frequencies of the free speeds, lowest first, from M ü = f by central differences in q and q̇.
std::vector<double> frequencies(const LoadedScene& s) {
  const State& state = s.scene.initial;
  const Layout& layout = s.scene.model->layout();
  const auto modes = static_cast<Eigen::Index>(layout.bodies[0].speeds);
  const auto first = layout.bodies[0].position;
  const auto force = [&](std::size_t index, double change) {
    State moved = state;
    moved.y[index] += change;
    const DenseSystem part = free_part(s.equations->system(0, moved.y));
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(part.force.data(), modes));
  };
  constexpr double h = 1e-5;
  Eigen::MatrixXd K(modes, modes), D(modes, modes);
  for (Eigen::Index i = 0; i < modes; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i);
    K.col(i) = (force(at, -h) - force(at, h)) / (2 * h);
    const std::size_t rate = layout.positions + layout.bodies[0].speed + static_cast<std::size_t>(i);
    D.col(i) = (force(rate, -h) - force(rate, h)) / (2 * h);
  }
  // Straight and inextensible: nothing couples through Coriolis accelerations.
  EXPECT_LT(D.cwiseAbs().maxCoeff(), 1e-6 * K.cwiseAbs().maxCoeff());
  const DenseSystem part = free_part(s.equations->system(0, state.y));
  const Eigen::Map<const Eigen::MatrixXd> M(part.mass.data(), modes, modes);  // symmetric at q = 0
  const Eigen::MatrixXd symmetric = 0.5 * (K + K.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric, Eigen::MatrixXd(M));
  std::vector<double> all;
  for (const double squared : eigen.eigenvalues()) all.push_back(squared);
  return all;
}

TEST(RotatingCantilever, frequencies_are_those_published) {
  for (const char* formulation : {"ruthless", "inconsistent", "consistent", "quadratic", "exact"}) {
    const bool stiffens = std::string(formulation) != "ruthless" && std::string(formulation) != "inconsistent";
    for (const Rotating& c : rotating) {
      for (const bool flap : {true, false}) {
        // ρA = 1, L = 1, EI = 1: η is the rate, μ the frequency.
        const LoadedScene s(
            "format: withy/1\nformulation: " + std::string(formulation) +
            "\nbodies:\n  hub: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n  blade: {type: beam, length: 1, "
            "mass_per_length: 1, bending_" +
            (flap ? "z" : "y") +
            ": {stiffness: 1, modes: 8, family: orthogonal-polynomials}}\nhinges:\n  axle: {type: revolute, axis: [0, "
            "0, "
            "1], parent: world, child: hub}\n  root: {type: weld, parent: hub, child: blade}\nmotions: {spin: {type: "
            "constant-rate, hinge: axle, rate: " +
            std::to_string(c.eta) + "}}\n");
        const std::vector<double> squared = frequencies(s);
        const double fixed[] = {rotating[0].flap1, rotating[0].flap2};
        const double published[] = {c.flap1, c.flap2};
        for (std::size_t k = 0; k < 2; ++k) {
          // Without second-order kinematics nothing stiffens; ruthless does not soften in the plane either.
          double expected = std::pow(stiffens ? published[k] : fixed[k], 2);
          if (!flap && std::string(formulation) != "ruthless") expected -= c.eta * c.eta;
          EXPECT_NEAR(squared[k], expected, 2e-4 * std::abs(expected) + 1e-4)
              << formulation << ", eta " << c.eta << (flap ? " flap " : " lag ") << k + 1;
        }
      }
    }
  }
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
}

/// A table whose hinge a host moves, at 0.3 rad and at rest at first; options of the motion follow.
std::string hosted_table(const std::string& options) {
  return turntable + "initial: {hinges: {axle: {position: [0.3]}}}\nmotions: {turn: {type: input, hinge: axle" +
         options + "}}\n";
}

/// A session of a scene in which a host sets what is called `turn`.
struct Hosted {
  explicit Hosted(const std::string& text)
      : loaded(text),
        session(*loaded.scene.model, *loaded.equations, *loaded.scene.integrator, loaded.scene.initial, {}) {
    for (std::size_t l = 0; l < loaded.scene.model->loads().size(); ++l)
      if (loaded.scene.model->loads()[l].name == "turn") input = l;
  }
  void to(double t, double value) {
    session.set_input(input, value);
    to(t);
  }
  void to(double t) { EXPECT_TRUE(session.advance(t, false).reached) << t; }
  double position() { return loaded.position(session.state(), "axle"); }
  double rate() { return loaded.rate(session.state(), "axle"); }
  /// That the motion needs at the present state [N m].
  double effort() {
    std::vector<double> efforts(loaded.equations->layout().speeds);
    Work work = loaded.equations->make_work();
    EXPECT_TRUE(loaded.equations->motion_efforts(session.state().time, session.state().y, efforts, work).ok());
    return efforts[loaded.hinge("axle").speed];
  }
  LoadedScene loaded;
  std::size_t input = 0;
  Session session;
};

/// Until it is set a hinge rests. Along q = 0.3 + 0.2 t², sampled at uneven times, the cubics are that parabola; after
/// the last one the rate stays, without effort. Along a sine rates are right to second order in the step.
TEST(MotionsOfHosts, reach_positions_along_cubics_of_second_order) {
  Hosted c(hosted_table(""));
  c.to(0.05);
  EXPECT_NEAR(c.position(), 0.3, 1e-12);
  EXPECT_EQ(c.session.input(c.input), c.position());
  Hosted p(hosted_table(""));
  for (const double t : {0.1, 0.25, 0.3, 0.5, 0.9}) {
    p.to(t, 0.3 + 0.2 * t * t);
    EXPECT_NEAR(p.position(), 0.3 + 0.2 * t * t, 1e-9) << t;
    EXPECT_NEAR(p.rate(), 0.4 * t, 1e-8) << t;
    EXPECT_NEAR(p.effort(), 0.2 * 0.4, 1e-8) << t;
    EXPECT_NEAR(p.session.input(p.input), p.position(), 1e-9);
  }
  p.to(1.5);
  EXPECT_NEAR(p.position(), 0.3 + 0.2 * 0.81 + 0.36 * 0.6, 1e-9);
  EXPECT_NEAR(p.effort(), 0, 1e-8);
  EXPECT_NEAR(p.session.state().y.back(), 0.5 * 0.2 * 0.36 * 0.36, 1e-9) << "work is the kinetic energy";
  double before = 0;
  for (const double h : {0.02, 0.01}) {
    Hosted s(hosted_table(""));
    double worst = 0;
    for (int k = 1; k * h < 1.5; ++k) {
      s.to(k * h, 0.3 + 0.1 * (1 - std::cos(4 * k * h)));
      worst = std::max(worst, std::abs(s.rate() - 0.4 * std::sin(4 * k * h)));
    }
    EXPECT_LT(worst, 1e-3);
    if (before > 0) {
      EXPECT_NEAR(before / worst, 4, 0.5);
    }
    before = worst;
  }
}

TEST(MotionsOfHosts, reach_rates_in_straight_lines_and_take_accelerations_at_once) {
  Hosted r(hosted_table(", sets: rate"));
  r.to(0.5, 1);
  EXPECT_NEAR(r.rate(), 1, 1e-9);
  EXPECT_NEAR(r.position(), 0.3 + 0.25, 1e-9);
  EXPECT_NEAR(r.effort(), 0.2 * 2, 1e-9);
  r.to(1);
  EXPECT_NEAR(r.rate(), 1, 1e-9);
  EXPECT_NEAR(r.position(), 0.55 + 0.5, 1e-9);
  EXPECT_NEAR(r.effort(), 0, 1e-9);
  Hosted a(hosted_table(", sets: acceleration"));
  a.to(0.5, 2);
  a.to(1);
  EXPECT_NEAR(a.rate(), 2, 1e-9) << "it holds";
  EXPECT_NEAR(a.position(), 0.3 + 1, 1e-9);
  Hosted l(hosted_table(", sets: acceleration, hold: linear"));
  l.to(0.5, 2);
  EXPECT_NEAR(l.rate(), 0.5, 1e-9);
  EXPECT_NEAR(l.position(), 0.3 + 2 * 0.25 / 6, 1e-9);
  l.to(1);
  EXPECT_NEAR(l.rate(), 1.5, 1e-9);
  EXPECT_THAT(problem_of(hosted_table(", hold: linear")), HasSubstr("a position is reached at the end of a step"));
  EXPECT_THAT(problem_of(hosted_table("") + "loads: {turn: {type: input, hinge: axle}}\n"),
              HasSubstr("which is that of a load"));
  EXPECT_THAT(problem_of(hosted_table("") + "loads: {servo: {type: pid, of: axle, to: turn, proportional: 1}}\n"),
              HasSubstr("turn"));
}

/// A flexible arm is moved as the dense equations with the same acceleration say, energy and work balance, and a
/// restored snapshot goes on bit by bit.
TEST(MotionsOfHosts, drive_flexible_trees_and_stand_in_snapshots) {
  for (const char* formulation : {"quadratic", "consistent", "exact"}) {
    Hosted c("format: withy/1\nformulation: " + std::string(formulation) + R"(
time: {end: 2}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 30, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  elbow: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
motions: {turn: {type: input, hinge: axle}}
)");
    const auto along = [](double t) { return 0.4 * (1 - std::cos(2 * t)); };
    for (int k = 1; k <= 20; ++k) c.to(0.05 * k, along(0.05 * k));
    const State& s = c.session.state();
    const auto seen = c.loaded.equations->make_observation();
    seen->observe(s.y);
    const Energies e = seen->energies();
    const double close = std::string(formulation) == "consistent" ? 1e-2 : 1e-7;
    EXPECT_NEAR(e.kinetic + e.potential, s.y.back(), close * e.kinetic) << formulation;
    std::vector<double> y_dot(c.loaded.equations->size());
    Work work = c.loaded.equations->make_work();
    ASSERT_TRUE(c.loaded.equations->derivatives(s.time, s.y, y_dot, work).ok());
    const DenseSystem dense = c.loaded.equations->system(s.time, s.y);
    ASSERT_EQ(dense.prescribed.size(), 1U);
    EXPECT_EQ(dense.prescribed[0].acceleration,
              y_dot[c.loaded.equations->layout().positions + dense.prescribed[0].speed]);
    EXPECT_GT(std::abs(dense.prescribed[0].acceleration), 0.1);
    const Checkpoint kept = c.session.snapshot();
    const auto go_on = [&] {
      c.to(1.07, along(1.07));
      c.to(1.3);
      return c.session.state().y;
    };
    const std::vector<double> once = go_on();
    c.session.restore(kept);
    EXPECT_EQ(go_on(), once) << formulation;
  }
}

}  // namespace
}  // namespace withy::test
