// What a certificate says of the momenta of a tree that floats freely.
#include <gtest/gtest.h>

#include <cmath>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

MomentumDrift drift_of(const std::string& scene) {
  const CertifiedRun r = run(prepare(SceneValues::parse(scene, "satellite.yaml"), plugins()), plugins());
  EXPECT_EQ(r.summary.status, RunStatus::completed) << r.summary.message;
  return r.certificate.momentum;
}

/// A satellite whose boom swings while it turns. \param float_more of its free hinge \param rate of it \param more
/// lines
std::string satellite(const std::string& formulation, const std::string& float_more, const std::string& rate,
                      const std::string& more) {
  return "format: withy/1\nformulation: " + formulation + R"(
time: {end: 2}
integrator: {name: dop853, rtol: 1e-10, atol: 1e-12}
bodies:
  bus: {type: rigid, mass: 3, center_of_mass: [0.1, 0, 0], inertia: [0.2, 0.2, 0.3, 0, 0, 0]}
  boom: {type: beam, length: 2, mass_per_length: 0.5, bending_y: {stiffness: 3, modes: 2}}
  tip: {type: rigid, mass: 0.5, inertia: [0.01, 0.02, 0.02, 0, 0, 0]}
hinges:
  float: {type: free, parent: world, child: bus)" +
         float_more + R"(}
  root: {type: revolute, axis: [0, 0.3, 1], parent: bus, child: boom}
  end: {type: weld, parent: boom.tip, child: tip}
initial: {hinges: {float: {rate: )" +
         rate + "}}, bodies: {boom: {modes: [0.1, 0]}}}\n" + more;
}

constexpr const char* turning = "[0.2, -0.1, 0.5, 0, 0, 0]";

/// But for that steps are others, at which peaks are looked for.
TEST(Momenta, AreOffByTheSameWhereverTheOriginIsAndHoweverFastAllMoves) {
  const MomentumDrift here = drift_of(satellite("rate-linear", "", turning, ""));
  ASSERT_TRUE(here.conserved);
  EXPECT_GT(std::min(here.linear, here.angular), 1e-3) << "what is truncated shows";
  EXPECT_LT(std::max(here.linear, here.angular), 1.5);
  const std::string away = ", offset: {position: [30, -20, 5], orientation: {axis: [1, 2, 3], angle: 0.7}}";
  for (const MomentumDrift& other : {drift_of(satellite("rate-linear", away, turning, "")),
                                     drift_of(satellite("rate-linear", "", "[0.2, -0.1, 0.5, 3, -2, 1]", "")),
                                     drift_of(satellite("rate-linear", away, "[0.2, -0.1, 0.5, 3, -2, 1]", ""))}) {
    EXPECT_NEAR(other.linear, here.linear, 1e-3 * here.linear);
    EXPECT_NEAR(other.angular, here.angular, 1e-3 * here.angular);
  }
}

TEST(Momenta, AreKeptByWhatIsNotTruncated) {
  for (const char* formulation : {"quadratic", "exact"}) {
    const MomentumDrift kept = drift_of(satellite(formulation, "", "[0.2, -0.1, 0.5, 3, -2, 1]", ""));
    ASSERT_TRUE(kept.conserved) << formulation;
    EXPECT_LT(std::max(kept.linear, kept.angular), 1e-8) << formulation;
  }
}

/// A body that flies without turning has no energy beside that of its velocity to measure by.
TEST(Momenta, OfABodyThatOnlyFliesAreOffByRounding) {
  const MomentumDrift kept = drift_of(R"(format: withy/1
time: {end: 1}
bodies: {ball: {type: rigid, mass: 0.3, inertia: [0.2, 0.3, 0.4, 0, 0, 0]}}
hinges: {float: {type: free, parent: world, child: ball}}
initial: {hinges: {float: {rate: [0, 0, 0, 0.3, 0.7, -0.1]}}}
)");
  ASSERT_TRUE(kept.conserved);
  EXPECT_LT(std::max(kept.linear, kept.angular), 1e-8);
}

constexpr const char* spring =
    "loads:\n  inner: {type: spring-damper, frame: bus, to: tip, stiffness: 2, damping: 0.1, free_length: 1}\n";

/// Truncated partial velocities of both ends do not cancel on the root, which pushes the tree: that is to be seen.
TEST(Momenta, AreToBeConservedUnderASpringBetweenTwoBodiesInAnyFormulation) {
  for (const char* formulation : {"quadratic", "consistent", "ruthless"}) {
    const MomentumDrift under = drift_of(satellite(formulation, "", turning, spring));
    EXPECT_TRUE(under.conserved) << formulation;
    if (formulation != std::string("quadratic")) {
      EXPECT_GT(under.angular, 1e-6) << formulation;
    }
  }
}

/// Beside it a push from outside is as little as rounding on the root.
TEST(Momenta, AreNotConservedUnderTheLeastPushFromOutside) {
  for (const char* formulation : {"quadratic", "consistent"})
    EXPECT_FALSE(drift_of(satellite(formulation, "", turning,
                                    spring + std::string("  push: {type: force, frame: tip, law: constant, value: "
                                                         "[1e-14, 0, 0]}\n")))
                     .conserved)
        << formulation;
  EXPECT_FALSE(
      drift_of(satellite("quadratic", "", turning,
                         "loads:\n  held: {type: spring-damper, frame: tip, anchor: [1, 0, 0], stiffness: 2}\n"))
          .conserved)
      << "to the world";
}

}  // namespace
}  // namespace withy::study
