// Units of what depends on whether something turns or slides: by what is measured and what is driven.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "withy/tests/scene/scene_fixture.hpp"

namespace withy {
namespace {

using testing::HasSubstr;

/// A cart that slides and carries an arm that turns; `u`, `v` and `f` act along the slide, about the arm's hinge and
/// with a force on the cart.
std::string problems_of(const std::string& loads, const std::string& reflected = "") {
  Registry registry;
  enroll_static_plugins(registry);
  return test::problems(R"(format: withy/1
time: {end: 1}
bodies: {cart: {type: rigid, mass: 1}, arm: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges:
  x: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart)" +
                            reflected + R"(}
  c: {type: revolute, axis: [0, 0, 1], parent: cart, child: arm}
outputs:
  place: {type: frame, of: arm}
  degrees: {type: expression, value: place.x * 57.3, unit: deg}
loads:
  u: {type: input, hinge: x}
  v: {type: input, hinge: c}
  f: {type: input, frame: cart, direction: [1, 0, 0]}
  p: )" + loads + '\n',
                        registry);
}

struct Case {
  const char *acts, *taken, *refused;
};

TEST(ControllerUnits, AreThoseOfWhatIsMeasuredAndDriven) {
  const std::vector<Case> cases = {
      {"of: x, to: u", "reference: 30 mm", "reference: 30 deg"},
      {"of: x, to: u", "motion: {type: quintic, to: 30 mm, duration: 1}",
       "motion: {type: quintic, to: 30 deg, duration: 1}"},
      {"of: x, to: u", "limit: 3 N", "limit: 3 Nm"},
      {"of: x, to: f", "limit: 3 N", "limit: 3 Nm"},
      {"of: c, to: f", "limit: 3 N", "limit: 3 Nm"},
      {"of: c, to: f", "proportional: 3 N/rad", "proportional: 3 Nm/rad"},
      {"of: x, hinge: c", "derivative: 3 N m s/m", "derivative: 3 N s/m"},
      {"of: x, hinge: c", "reference: 30 mm", "reference: 30 deg"},
      {"of: c, hinge: x", "limit: 3 N", "limit: 3 Nm"},
      {"of: c, to: v", "reference: 30 deg", "reference: 30 mm"},
      {"of: c, to: v", "proportional: 3 Nm/rad", "proportional: 3 N/m"},
      {"of: x.rate, to: u", "reference: 3 m/s", "reference: 3 rad/s"},
      {"of: place.x, to: u", "reference: 30 mm", "reference: 30 deg"},
      {"of: degrees, hinge: c", "reference: 30 deg", "reference: 30 mm"},
      {"of: degrees, hinge: c", "proportional: 3 Nm/deg", "proportional: 3 Nm/m"},
      {"of: degrees, hinge: x", "derivative: 3 N s/deg, filter: 0.1 s", "derivative: 3 Nm s/deg, filter: 0.1 s"},
      {"of: degrees, to: nothing", "integral: 3 N/(deg s)", "integral: 3 N/s"},
      {"of: x.rate, to: v", "proportional: 3 Nm s/m", "proportional: 3 Nm/m"},
      {"hinge: x", "reference: 30 mm", "reference: 30 deg"},
      {"hinge: c", "limit: 3 Nm", "limit: 3 N"},
  };
  for (const auto& [acts, taken, refused] : cases) {
    const auto told = [a = std::string(acts)](const std::string& what) {
      const std::string gain = what.starts_with("proportional") ? "" : ", proportional: 1";
      return problems_of("{type: pid, " + a + gain + ", " + what + "}");
    };
    EXPECT_EQ(told(taken), "") << acts << ", " << taken;
    EXPECT_THAT(told(refused), HasSubstr("is a wrong unit here")) << acts << ", " << refused;
  }
}

TEST(ControllerUnits, OfAnActuatorAreThoseOfWhatItDrives) {
  const auto told = [](const std::string& what) {
    return problems_of("{type: actuator, of: x, frequency: 30, " + what + "}");
  };
  EXPECT_EQ(told("to: u, limit: 3 N, rate_limit: 3 N/s"), "");
  EXPECT_EQ(told("to: v, limit: 3 Nm, rate_limit: 3 Nm/s"), "");
  EXPECT_THAT(told("to: u, limit: 3 Nm"), HasSubstr("is a wrong unit here"));
  EXPECT_THAT(told("to: v, rate_limit: 3 N/s"), HasSubstr("is a wrong unit here"));
}

/// Nobody knows what a command that other loads measure becomes.
TEST(ControllerUnits, OfACommandThatActsOnNothingAreEither) {
  for (const char* limit : {"3 N", "3 Nm"})
    EXPECT_EQ(problems_of(std::string("{type: pid, of: x, to: nothing, proportional: 1, limit: ") + limit + "}"), "");
}

TEST(HingeUnits, TheReflectedInertiaOfASlideIsAMass) {
  const auto told = [](const std::string& inertia) {
    return problems_of("{type: hinge-spring, hinge: x, stiffness: 1}", ", reflected_inertia: " + inertia);
  };
  EXPECT_EQ(told("4 kg"), "");
  EXPECT_THAT(told("4 kg m^2"), HasSubstr("'kg m^2' is a wrong unit here; need finite >= 0 [kg]"));
  EXPECT_THAT(told("-4"), HasSubstr("need finite >= 0"));
}

}  // namespace
}  // namespace withy
