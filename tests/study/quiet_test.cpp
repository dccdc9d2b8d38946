// What a certificate says where next to nothing moves: what rounding and the integrator's tolerance leave is no motion.
#include <gtest/gtest.h>

#include <algorithm>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

CertifiedRun certified_run(SceneValues values) {
  RunSettings settings;
  settings.estimate = Estimate::never;
  return run(prepare(std::move(values), plugins()), plugins(), settings);
}

/// A free hub of 10 kg with a boom, whose fastest mode has 79 rad/s.
/// \param rate of turning about z [rad/s]
/// \param bent coordinate of the boom's first mode at the start [m]
CertifiedRun drifting(const std::string& rate, const std::string& bent = "0") {
  return certified_run(SceneValues::parse(R"(
format: withy/1
time: {end: 10, output: 0.1}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-10}
bodies:
  hub: {type: rigid, mass: 10, inertia: [1, 2, 3, 0, 0, 0]}
  boom: {type: beam, length: 2, mass_per_length: 0.5, bending_y: {stiffness: 100, modes: 2}, bending_z: {stiffness: 100, modes: 2}}
hinges:
  float: {type: free, parent: world, child: hub}
  root: {type: weld, parent: hub, child: boom}
initial: {hinges: {float: {rate: [0, 0, )" + rate +
                                              R"(, 1.1, 0.3, 0.7]}}, bodies: {boom: {modes: [)" + bent +
                                              R"(, 0, 0, 0]}}}
)",
                                          "drifting"));
}

bool tells_modes(const Certificate& c) {
  return std::any_of(c.indicators.begin(), c.indicators.end(),
                     [](const Indicator& i) { return i.text.find("energy of the highest") != std::string::npos; });
}

// Five steps of 2 s, where the fastest vibration is stable to 0.02 s: it is not there.
TEST(QuietStructures, StabilityLimitsNoStepsFarBeyondIt) {
  const Certificate still = drifting("0").certificate;
  EXPECT_GT(still.steps.mean * still.steps.fastest, 3 * *still.steps.limit);
  EXPECT_EQ(still.steps.moving, 0) << "the hub's drift is no vibration";
  EXPECT_EQ(still.steps.cause(), "accuracy");
  EXPECT_TRUE(still.steps.unlimited.empty()) << "nothing to be helped";
  const Certificate slow = drifting("1e-6").certificate;
  EXPECT_FALSE(slow.steps.fastest_rests());
  EXPECT_EQ(slow.steps.cause(), "stability") << "it rings within the tolerance, and grows in longer steps";
}

// Turning at 1e-6 rad/s the boom bends by some tolerances: nearly all of it in the second mode.
TEST(QuietStructures, ModesThatTheToleranceMovesHaveNoShares) {
  const CertifiedRun slow = drifting("1e-6");
  ASSERT_EQ(slow.summary.validity.bodies.size(), 1U);
  EXPECT_GT(slow.summary.validity.bodies[0].highest[0].share, 0.1) << "what would be told";
  EXPECT_FALSE(tells_modes(slow.certificate));
  EXPECT_TRUE(slow.certificate.bodies[0].highest.empty());
  const CertifiedRun vibrating = drifting("1e-6", "0.001");
  EXPECT_TRUE(tells_modes(vibrating.certificate));
  ASSERT_EQ(vibrating.certificate.bodies[0].highest.size(), 2U);
  EXPECT_LT(vibrating.certificate.bodies[0].highest[0].share, 0.1);
}

// The orbit's plane turned in space: out of it the boom bends by what rounding leaves at 6,778 km, whose highest mode
// has as much as its lowest.
TEST(QuietStructures, AFamilyThatRoundingMovesHasNoHighestMode) {
  SceneValues values = scene("gallery/orbiting-boom");
  values.set_text("hinges.orbit.offset.orientation=[0.3015113446, -0.5025189076, 0.7035264707, 0.4020151261]");
  values.set_text("time.end=2000");
  const CertifiedRun orbit = certified_run(std::move(values));
  ASSERT_EQ(orbit.summary.validity.bodies.size(), 1U);
  for (const HighestMode& h : orbit.summary.validity.bodies[0].highest)
    if (h.family == "bending_z") {
      EXPECT_LT(h.share, 1e-3);
    }
}

}  // namespace
}  // namespace withy::study
