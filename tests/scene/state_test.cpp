#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "scene_fixture.hpp"

namespace withy::test {
namespace {

class States : public SceneTest {
 protected:
  States() : scene(parse_scene(file_text("scenes/spacecraft.yaml"), "spacecraft.yaml", registry)) {}
  std::string problem(const std::string& text) {
    try {
      parse_state(text, "state.json", scene);
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  }
  Scene scene;
};

TEST_F(States, ComeBackFromJsonWithTheSameBits) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> digits(-1, 1);
  std::uniform_int_distribution<int> exponent(-300, 300);
  const Model& model = *scene.model;
  for (int round = 0; round < 200; ++round) {
    State state = model.reference_state();
    state.time = std::abs(digits(random));
    for (double& y : state.y) y = std::ldexp(digits(random), exponent(random));
    state.y[0] = -0.0;
    state.y.back() = std::numeric_limits<double>::denorm_min();
    for (std::size_t h = 0; h < model.hinges().size(); ++h) {
      // Quaternions are unit to rounding, as those of a simulation are.
      const Slot& slot = model.layout().hinges[h];
      if (slot.positions < 4) continue;
      double q[4];
      double norm = 0;
      for (double& x : q) norm += (x = digits(random), x * x);
      for (std::size_t i = 0; i < 4; ++i) state.y[slot.position + i] = q[i] / std::sqrt(norm);
    }
    const State back = parse_state(write_state(model, state), "s", model, model.reference_state());
    EXPECT_EQ(back.time, state.time);
    ASSERT_EQ(back.y.size(), state.y.size());
    for (std::size_t i = 0; i < state.y.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(back.y[i]), std::bit_cast<std::uint64_t>(state.y[i])) << i;
    }
  }
}

TEST_F(States, OfARunAreTheOnesThatItEndedWith) {
  const std::string end = R"({"time": 2.5, "hinges": {"right_slide": {"position": [0.1], "rate": [0.7]}}})";
  const State alone = parse_state(end, "s", *scene.model, scene.initial);
  const State of_run = parse_state(R"({"scene": "s.yaml", "status": "completed", "final": )" + end + "}", "run.json",
                                   *scene.model, scene.initial);
  EXPECT_EQ(of_run.time, 2.5);
  EXPECT_EQ(of_run.y, alone.y);
  EXPECT_THAT(problem(R"({"status": "completed", "final": {"hinges": {"right_slid": {"rate": [0.7]}}}})"),
              testing::HasSubstr("/final/hinges/right_slid"));
}

TEST_F(States, LeaveWhatTheyDoNotNameAsItWas) {
  const State state = parse_state(R"({"hinges": {"right_slide": {"rate": [0.7]}}})", "s", *scene.model, scene.initial);
  const Slot* slide = scene.model->layout().hinge("right_slide");
  State expected = scene.initial;
  expected.y[scene.model->layout().positions + slide->speed] = 0.7;
  EXPECT_EQ(state.y, expected.y);
}

// A derivative's filter begins at the error, 1 − x here, so that the derivative is zero.
TEST_F(States, HaveControllersBeginThereThatNeitherTheyNorTheSceneName) {
  const std::string text = R"(format: withy/1
time: {end: 1}
bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}}
loads:
  servo: {type: pid, hinge: h, proportional: 4, integral: 2, derivative: 3, filter: 0.1, reference: 1}
)";
  const Scene plain = parse_scene(text, "s", registry);
  const auto states = [&](const Scene& of, const char* state) {
    const State s = parse_state(state, "s", of);
    const LoadSlot& slot = of.model->layout().continuous_slots.at(0);
    std::map<std::string, double> named;
    for (std::size_t i = 0; i < slot.count; ++i)
      named[of.model->loads()[slot.load].continuous->name(i)] = s.y[slot.first + i];
    return named;
  };
  using Named = std::map<std::string, double>;
  EXPECT_EQ(states(plain, "time: 0"), (Named{{"filter", 1}, {"integral", 0}}));
  EXPECT_EQ(states(plain, "hinges: {h: {position: 0.25}}"), (Named{{"filter", 0.75}, {"integral", 0}}));
  EXPECT_EQ(states(plain, "{hinges: {h: {position: 0.25}}, loads: {servo: {filter: 1}}}"),
            (Named{{"filter", 1}, {"integral", 0}}));
  const Scene stated = parse_scene(text + "initial: {loads: {servo: {filter: 0.5, integral: 0.3}}}\n", "s", registry);
  EXPECT_EQ(states(stated, "hinges: {h: {position: 0.25}}"), (Named{{"filter", 0.5}, {"integral", 0.3}}));
  // The filter would begin at 1 in the scene: said, it stays there all the same, and what is not said begins anew.
  const Scene same = parse_scene(text + "initial: {loads: {servo: {filter: 1}}}\n", "s", registry);
  EXPECT_EQ(states(same, "hinges: {h: {position: 0.25}}"), (Named{{"filter", 1}, {"integral", 0}}));
}

TEST_F(States, MayCarryUnitsWhereTheHingeIsKnown) {
  const State s =
      parse_state("hinges: {left_drive: {position: [90 deg], rate: [60 rpm]}, right_slide: {position: [5 mm]}}", "s",
                  *scene.model, scene.initial);
  const Layout& layout = scene.model->layout();
  EXPECT_DOUBLE_EQ(s.y[layout.hinge("left_drive")->position], 1.5707963267948966);
  EXPECT_DOUBLE_EQ(s.y[layout.positions + layout.hinge("left_drive")->speed], 6.283185307179586);
  EXPECT_EQ(s.y[layout.hinge("right_slide")->position], 0.005);
}

TEST_F(States, TakeANumberAloneWhereThereIsOne) {
  const auto state = [&](const char* text) { return parse_state(text, "s", *scene.model, scene.initial); };
  EXPECT_EQ(state("hinges: {left_drive: {position: 90 deg, rate: 60 rpm}, right_slide: {position: 0.005}}").y,
            state("hinges: {left_drive: {position: [90 deg], rate: [60 rpm]}, right_slide: {position: [0.005]}}").y);
  EXPECT_THAT(problem("hinges: {gimbal: {rate: 1 deg/s}}"), testing::HasSubstr("need a list of 3 finite numbers"));
  EXPECT_THAT(problem("hinges: {left_drive: {rate: 1 m/s}}"), testing::HasSubstr("'m/s' is a wrong unit here"));
}

// Units come from the motion: a hinge need not be one the sweeps know.
TEST_F(States, MayCarryUnitsOnEveryHinge) {
  const Scene screws = parse_scene(R"(format: withy/1
bodies: {a: {type: rigid, mass: 1}, b: {type: rigid, mass: 1}}
hinges:
  screw: {type: screw, axis: [0, 0, 1], pitch: 0.1, parent: world, child: a}
  sleeve: {type: cylindrical, axis: [0, 0, 1], parent: a, child: b}
initial:
  hinges:
    screw: {position: [90 deg], rate: [60 rpm]}
    sleeve: {position: [1 rev, 5 mm], rate: [1 deg/s, 3 cm/s]}
)",
                                   "s", registry);
  const double pi = std::numbers::pi;
  const std::vector<double> expected{pi / 2, 2 * pi, 0.005, 2 * pi, pi / 180, 0.03, 0};
  ASSERT_EQ(screws.initial.y.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_DOUBLE_EQ(screws.initial.y[i], expected[i]);
  try {
    parse_state("hinges: {sleeve: {position: [1 m, 1 m]}}", "s", *screws.model, screws.initial);
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("rad"));
  }
}

TEST_F(States, ScaleQuaternionsThatAreNearlyUnit) {
  const State s =
      parse_state("hinges: {gimbal: {position: [0.60000003, 0.8, 0, 0]}}", "s", *scene.model, scene.initial);
  const std::size_t at = scene.model->layout().hinge("gimbal")->position;
  EXPECT_NEAR(std::hypot(s.y[at], s.y[at + 1]), 1, 2e-16);
}

TEST_F(States, AreCheckedAgainstTheModel) {
  using testing::StartsWith;
  EXPECT_THAT(problem(R"({"hinges": {"gimbel": {}}})"),
              StartsWith("state.json:1:13: /hinges/gimbel: no hinge \"gimbel\"; did you mean 'gimbal'?"));
  EXPECT_THAT(problem(R"({"bodies": {"left_bom": {}}})"), testing::HasSubstr("did you mean 'left_boom'?"));
  EXPECT_THAT(problem(R"({"bodies": {"bus": {}}})"), testing::HasSubstr("body 'bus' is rigid: it has no modes"));
  EXPECT_THAT(problem(R"({"hinges": {"gimbal": {"position": [1, 0, 0]}}})"),
              StartsWith("state.json:1:36: /hinges/gimbal/position: got a list of 3; need a list of 4"));
  EXPECT_THAT(problem(R"({"hinges": {"gimbal": {"rate": [1, 0, 0, 0]}}})"), testing::HasSubstr("need a list of 3"));
  EXPECT_THAT(problem(R"({"hinges": {"gimbal": {"position": [1, 1, 0, 0]}}})"),
              testing::HasSubstr("got a quaternion of norm 1.4142135623730951; need norm 1"));
  EXPECT_THAT(problem(R"({"bodies": {"left_boom": {"modes": [1, 2]}}})"), testing::HasSubstr("need a list of 5"));
  EXPECT_THAT(problem(R"({"bodies": {"left_boom": {"rates": [1, 2, 3, 4, null]}}})"),
              testing::HasSubstr("/bodies/left_boom/rates/4: got nothing; need finite"));
  EXPECT_THAT(problem(R"({"hinge": {}})"), testing::HasSubstr("unknown key \"hinge\"; did you mean 'hinges'?"));
  EXPECT_THAT(problem(R"({"time": "soon"})"), testing::HasSubstr("/time: got \"soon\"; need finite [s]"));
  EXPECT_THAT(problem("{"), StartsWith("state.json:1:1: a list or map that is never closed"));
  EXPECT_THAT(problem("{\"time\": 1"), StartsWith("state.json:1:"));
}

TEST_F(States, BeginOnTheTrajectoryThatIsFollowedAtTheirTime) {
  const std::string text = R"(format: withy/1
time: {end: 4}
bodies: {a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}}
loads:
  servo:
    type: pd-controller
    law: sine
    period: 4
    time_scale: 2
    hinges: {h: {amplitude: 1, center: 0.5, phase: 30 deg, stiffness: 2, damping: 1}}
)";
  const auto begun = [&](const std::string& initial) { return parse_scene(text + initial, "s", registry).initial; };
  const double pi = std::numbers::pi;
  EXPECT_NEAR(begun("").y[0], 0.5 + std::sin(pi / 6), 1e-15);
  const State later = begun("initial: {time: 1}\n");
  EXPECT_NEAR(later.y[0], 0.5 + std::sin(7 * pi / 6), 1e-15);
  EXPECT_NEAR(later.y[1], pi * std::cos(7 * pi / 6), 1e-14);
  EXPECT_EQ(begun("initial: {time: 1, hinges: {h: {position: 0.25}}}\n").y[0], 0.25);
  EXPECT_THAT(problems(text + "initial: {time: soon}\n", registry), testing::HasSubstr("/initial/time: got \"soon\""));
}

TEST_F(States, OfASlewBeginWhereItBegins) {
  const Scene slew = parse_scene(file_text("scenes/two-link-slew.yaml"), "s", registry);
  const Layout& layout = slew.model->layout();
  EXPECT_DOUBLE_EQ(slew.initial.y[layout.hinge("elbow")->position], 2.356194490192345);  // 135°
  EXPECT_EQ(slew.initial.y[layout.hinge("shoulder")->position], 0);
  EXPECT_DOUBLE_EQ(slew.end.value(), 3.8);
  const SceneOptions options{"", "", {"loads.slew.time_scale=2", "initial.hinges.elbow.position=[1]"}};
  const Scene faster = parse_scene(file_text("scenes/two-link-slew.yaml"), "s", registry, options);
  EXPECT_DOUBLE_EQ(faster.end.value(), 1.9);
  EXPECT_EQ(faster.initial.y[layout.hinge("elbow")->position], 1);
}

}  // namespace
}  // namespace withy::test
