// A run that a loop of sampled loads has ended says so, with the growth that its difference equation has; one that ends
// for another reason does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "withy/study/run.hpp"
#include "withy/tests/study/message.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::number_after;
using test::plugins;
using testing::HasSubstr;
using testing::Not;

/// A rigid rotor under a sampled controller.
RunSummary rotor(double derivative, const std::string& more) {
  const SceneValues values = SceneValues::parse(
      "format: withy/1\nformulation: quadratic\ntime: {end: 60}\n"
      "bodies: {rotor: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}\n"
      "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: rotor}}\n"
      "initial: {hinges: {axle: {position: [1e-3]}}}\n"
      "loads:\n  law: {type: pid, of: axle, hinge: axle, proportional: 100, derivative: " +
          std::to_string(derivative) + ", sample: 0.1}\n" + more,
      "sampled.yaml");
  RunSettings settings;
  settings.look_beyond = false;
  return run(prepare(values, plugins()), plugins(), settings).summary;
}

/// ln |z| / T of the greater root of its difference equation.
double growth_in_theory(double derivative) {
  const double inertia = 2, sample = 0.1, proportional = 100;
  const double by_angle = sample * sample / 2 / inertia, by_rate = sample / inertia;
  const double a = 1 - by_angle * proportional, b = sample - by_angle * derivative;
  const double c = -by_rate * proportional, d = 1 - by_rate * derivative;
  const double half = (a + d) / 2;
  return std::log(std::abs(half) + std::sqrt(half * half - (a * d - b * c))) / sample;
}

TEST(SampledGrowth, OfALoopThatIsUnstableIsNamedAsTheCause) {
  const RunSummary s = rotor(60, "");
  EXPECT_TRUE(s.status == RunStatus::diverged || s.status == RunStatus::step_underflow) << s.message;
  EXPECT_THAT(s.message, HasSubstr("the loop of what is sampled, 'law', every 0.1 s, is unstable"));
  // Printed with three digits.
  EXPECT_NEAR(number_after(s.message, "small motions grow by "), growth_in_theory(60), 0.005) << s.message;
  EXPECT_THAT(s.message, HasSubstr("as it is there nothing grows"));
}

TEST(SampledGrowth, IsNotNamedWhereTheLoopIsStable) {
  const std::string wild = "  wild: {type: expression, hinge: axle, value: 1/(2 - t)}\n";
  const RunSummary stable = rotor(20, wild), unstable = rotor(60, wild);
  EXPECT_NE(stable.status, RunStatus::completed);
  EXPECT_THAT(stable.message, Not(HasSubstr("what is sampled")));
  EXPECT_THAT(unstable.message, HasSubstr("what is sampled"));
}

}  // namespace
}  // namespace withy::study
