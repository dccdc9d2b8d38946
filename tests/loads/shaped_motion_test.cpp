// Motions that are shaped: what is left of a mode after them, and what is refused.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "withy/tests/conformance/motion_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

using std::numbers::pi;

/// The driven table, and on it a disk of 0.5 kg m² on a spring about the same axis: 0.5 (θ̈ + ẍ) + c ẋ + k x = 0.
struct Oscillator {
  double stiffness = 20, damping = 0;
  [[nodiscard]] double frequency() const { return std::sqrt(stiffness / 0.5); }  ///< ω [rad/s]
  [[nodiscard]] double ratio() const { return damping / (2 * std::sqrt(stiffness * 0.5)); }
  [[nodiscard]] double damped() const { return frequency() * std::sqrt(1 - ratio() * ratio()); }
};

constexpr const char* slew = "{type: quintic, to: 1, duration: 0.6}";

std::string shaped(const std::string& shaper, const std::string& modes, const std::string& motion = slew) {
  return "{type: shaped, shaper: " + shaper + ", modes: [" + modes + "], motion: " + motion + "}";
}

std::string mode(double hertz, double ratio) {
  return "[" + std::to_string(hertz) + ", " + std::to_string(ratio) + "]";
}

/// Amplitude of each oscillator's vibration at 4 s, when all has come to its end.
std::vector<double> left_after(const std::string& motion, const std::vector<Oscillator>& oscillators) {
  std::string text = R"(format: withy/1
time: {end: 4, output: 4}
integrator: {name: dopri5, rtol: 1e-11, atol: 1e-13}
bodies:
  table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
)";
  std::string hinges = "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}\n";
  std::string springs = "loads:\n";
  for (std::size_t i = 0; i < oscillators.size(); ++i) {
    const std::string name = "disk" + std::to_string(i);
    text += "  " + name + "-body: {type: rigid, mass: 1, inertia: [0.4, 0.4, 0.5, 0, 0, 0]}\n";
    hinges += "  " + name + ": {type: revolute, axis: [0, 0, 1], parent: table, child: " + name + "-body}\n";
    springs += "  " + name + "-spring: {type: hinge-spring, hinge: " + name +
               ", stiffness: " + std::to_string(oscillators[i].stiffness) +
               ", damping: " + std::to_string(oscillators[i].damping) + "}\n";
  }
  LoadedScene s(text + hinges + springs + "motions: {turn: {hinge: axle, " + motion.substr(1) + "}\n");
  const State last = s.run().back();
  std::vector<double> amplitudes;
  for (std::size_t i = 0; i < oscillators.size(); ++i) {
    const Oscillator& o = oscillators[i];
    const std::string name = "disk" + std::to_string(i);
    const double x = s.position(last, name), v = s.rate(last, name);
    amplitudes.push_back(std::hypot(x, (v + o.ratio() * o.frequency() * x) / o.damped()));
  }
  return amplitudes;
}

int order_of(const std::string& shaper) { return shaper == "zv" ? 1 : shaper == "zvd" ? 2 : 3; }

class Shapers : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, Shapers, testing::Values("zv", "zvd", "zvdd"));

TEST_P(Shapers, leave_a_damped_mode_at_rest_and_end_where_they_say) {
  const Oscillator o{20, 0.3};
  const double hertz = o.frequency() / (2 * pi), plain = left_after(slew, {o})[0];
  const std::string motion = shaped(GetParam(), mode(hertz, o.ratio()));
  ASSERT_GT(plain, 0.01);
  // The text states the mode to six digits.
  EXPECT_LT(left_after(motion, {o})[0], 3e-6 * plain);
  LoadedScene s(turntable + "motions: {turn: {hinge: axle, " + motion.substr(1) + "}\n");
  const Motion& law = *s.scene.model->motions()[0].motion;
  EXPECT_NEAR(law.end(), 0.6 + order_of(GetParam()) * pi / o.damped(), 1e-5);
  EXPECT_NEAR(law.at(law.end()).position, 1, 1e-15);
  EXPECT_LT(law.at(law.end() - 0.05).position, 1);
  expect_motion_conforms(law);
}

/// Of a mode that has r times the frequency that is stated |cos(π r/2)|ⁿ is left (Singer & Seering 1990).
TEST_P(Shapers, leave_of_a_mode_at_another_frequency_what_theory_says) {
  const Oscillator o;
  const double plain = left_after(slew, {o})[0];
  for (const double r : {0.7, 0.9, 1.05, 1.3}) {
    const double hertz = o.frequency() / (2 * pi) / r;
    const double left = left_after(shaped(GetParam(), mode(hertz, 0)), {o})[0] / plain;
    EXPECT_NEAR(left, std::pow(std::abs(std::cos(pi * r / 2)), order_of(GetParam())), 3e-6) << r;
  }
}

TEST_P(Shapers, of_several_modes_leave_all_of_them_at_rest) {
  const std::vector<Oscillator> both = {{20, 0.1}, {90, 0.2}};
  const std::vector<double> plain = left_after(slew, both);
  const std::string first = mode(both[0].frequency() / (2 * pi), both[0].ratio());
  const std::string second = mode(both[1].frequency() / (2 * pi), both[1].ratio());
  const std::vector<double> left = left_after(shaped(GetParam(), first + ", " + second), both);
  const std::vector<double> one = left_after(shaped(GetParam(), first), both);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_LT(left[i], 1e-5 * plain[i]) << i;
  EXPECT_GT(one[1], 1e-3 * plain[1]);
  // One shaper after the other is the same.
  const std::vector<double> nested = left_after(shaped(GetParam(), second, shaped(GetParam(), first)), both);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(nested[i], left[i], 1e-9 * plain[i]) << i;
}

TEST(ShapedMotion, without_a_shaper_is_what_it_shapes) {
  LoadedScene s(turntable + "motions: {turn: {hinge: axle, " + shaped("none", "[1, 0.1]").substr(1) + "}\n");
  LoadedScene plain(turntable + "motions: {turn: {hinge: axle, " + std::string(slew).substr(1) + "}\n");
  const Motion &law = *s.scene.model->motions()[0].motion, &other = *plain.scene.model->motions()[0].motion;
  EXPECT_EQ(law.end(), other.end());
  EXPECT_EQ(law.discontinuities(), other.discontinuities());
  for (const double t : {-0.1, 0.2, 0.5, 1.0}) EXPECT_EQ(law.at(t).acceleration, other.at(t).acceleration) << t;
}

TEST(ShapedMotion, declares_the_jumps_of_every_copy) {
  LoadedScene s(turntable + "motions: {turn: {hinge: axle, " + shaped("zv", "[1, 0]").substr(1) + "}\n");
  EXPECT_THAT(s.scene.model->motions()[0].motion->discontinuities(),
              testing::Pointwise(testing::DoubleEq(), {0.0, 0.5, 0.6, 1.1}));
}

/// The disk in a loop with a controller: what it follows is shaped, and the run lasts until the end of that.
TEST(ShapedMotion, is_followed_by_controllers) {
  const std::string motion = shaped("zv", "[1, 0]");
  LoadedScene s(
      turntable.substr(0, turntable.find("time:")) + turntable.substr(turntable.find("integrator:")) +
      "time: {output: 0.05}\nloads: {servo: {type: pd-controller, law: motion, hinges: {axle: {stiffness: 4000, "
      "damping: 80, motion: " +
      motion + "}}}}\n");
  const std::vector<State> states = s.run();
  EXPECT_NEAR(states.back().time, 1.1, 1e-12);
  EXPECT_NEAR(s.position(states.back(), "axle"), 1, 1e-3);
}

TEST(ShapedMotion, refuses_what_cannot_be_shaped) {
  const auto problem = [](const std::string& motion) {
    return problem_of(turntable + "motions: {turn: {hinge: axle, " + motion.substr(1) + "}\n");
  };
  EXPECT_EQ(problem(shaped("zvd", "[1, 0]")), "");
  EXPECT_THAT(problem(shaped("zvd", "[1, 0]", "locked")), HasSubstr("'locked' is no function of time"));
  EXPECT_THAT(problem(shaped("zvd", "[1, 0]", "input")), HasSubstr("'input' is no function of time"));
  EXPECT_THAT(problem(shaped("zvd", "")), HasSubstr("/motions/turn/modes: got a list of 0"));
  EXPECT_THAT(problem(shaped("zvd", "[0, 0.1]")), HasSubstr("needs a frequency > 0"));
  EXPECT_THAT(problem(shaped("zvd", "[1, 1]")), HasSubstr("damping ratio >= 0 and < 1"));
  EXPECT_THAT(problem(shaped("zvdd", "[1, 0], [2, 0], [3, 0], [4, 0], [5, 0], [6, 0]")), HasSubstr("1024 copies"));
  EXPECT_THAT(problem(shaped("zdv", "[1, 0]")), HasSubstr("need one of: none, zv, zvd, zvdd"));
  EXPECT_THAT(problem(shaped("zvd", "[1, 0]", "{type: quintik, to: 1, duration: 1}")), HasSubstr("quintic"));
}

}  // namespace
}  // namespace withy::test
