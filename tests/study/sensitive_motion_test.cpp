// What runs of formulation `auto` say where two runs of the same equations part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

/// A soft arm with a rigid one at its tip, released near the top: `exact` is chosen for all of it.
CertifiedRun double_pendulum() {
  const SceneValues values = SceneValues::parse(R"(format: withy/1
gravity: [0, -9.81, 0]
formulation: {name: auto, accuracy: 1 %}
integrator: {name: dopri5, rtol: 1.0e-7, atol: 1.0e-9}
time: {end: 20, output: 0.02}
bodies:
  a: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 15, modes: 2}}
  b: {type: rigid, mass: 0.5, center_of_mass: [0.5, 0, 0], inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
hinges:
  h: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  e: {type: revolute, axis: [0, 0, 1], parent: a.tip, child: b}
initial: {hinges: {h: {position: [3]}, e: {position: [0.5]}}}
)",
                                                "pendulum.yaml");
  return run(prepare(values, plugins()), plugins());
}

TEST(SensitiveMotion, OfARunInOneFormulationThroughoutIsNoErrorOfZero) {
  const CertifiedRun r = double_pendulum();
  ASSERT_TRUE(r.certificate.plan && r.certificate.plan->throughout);
  EXPECT_EQ(r.summary.status, RunStatus::inaccurate);
  EXPECT_THAT(r.summary.message, HasSubstr("The motion is sensitive: a run of the same equations at rtol"));
  EXPECT_FALSE(r.certificate.estimate);
  EXPECT_THAT(r.certificate.without_estimate,
              HasSubstr("what integration leaves is not known: The motion is sensitive"));
}

TEST(SensitiveMotion, IsNotClaimedWhereAnotherRunComesToTheSame) {
  SceneValues values = scene("driven-arm");
  const CertifiedRun r = run(prepare(values.choose_formulation("auto", "the test"), plugins()), plugins());
  ASSERT_TRUE(r.certificate.plan && r.certificate.plan->throughout);
  EXPECT_EQ(r.summary.status, RunStatus::completed) << r.summary.message;
  EXPECT_FALSE(r.certificate.estimate) << "nothing has been compared";
  EXPECT_LT(r.certificate.plan->apart, 0.3);
  EXPECT_THAT(r.certificate.without_estimate, HasSubstr("none against exact, in which all of the run is; another run"));
}

}  // namespace
}  // namespace withy::study
