// What second-order kinematics leaves out of bending, of twist, and of both together.
#include "withy/study/third_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

/// One function of each kind on one metre: the deflection v x², whose end has the slope 2 v, and a twist that grows
/// evenly.
struct TwistedAndBent {
  TwistedAndBent()
      : prepared(prepare(SceneValues::parse(R"(format: withy/1
time: {end: 1}
formulation: quadratic
bodies:
  b: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 20, modes: 1, family: orthogonal-polynomials}, torsion: {stiffness: 1, inertia: 0.01, modes: 1, family: orthogonal-polynomials}}
hinges: {r: {type: weld, parent: world, child: b}}
)",
                                            "twisted.yaml"),
                         plugins())),
        tip(prepared.model().bodies()[0].frame("tip")) {}

  /// The share where the tip is deflected [m] and twisted [rad] so far, each by what a unit of its coordinate gives.
  [[nodiscard]] double share(double deflection, double twist) const {
    State state = prepared.scene.initial;
    const std::size_t q = prepared.model().layout().modes(0)->position;
    state.y[q] = deflection / displaced(q);
    state.y[q + 1] = twist / turned(q + 1);
    ThirdOrder all(prepared);
    all.look(prepared.scene.initial);
    all.look(state);
    all.look(prepared.scene.initial);
    return third_order_share(all.bend());
  }
  [[nodiscard]] double displaced(std::size_t coordinate) const {
    std::vector<double> y = prepared.scene.initial.y;
    y[coordinate] = 1;
    return prepared.equations->deflection(y, 0, tip)[1];
  }
  [[nodiscard]] double turned(std::size_t coordinate) const {
    std::vector<double> y = prepared.scene.initial.y;
    y[coordinate] = 1e-3;
    const std::array<double, 9> R = prepared.equations->frame_pose(y, 0, tip).rotation;
    return 1e3 * std::atan2(R[7], R[4]);
  }

  Prepared prepared;
  int tip;
};

// v = 0.05 m: (d/L)² = 0.0025, d being longer than v by half the square of the foreshortening ⅔ v². With a twist of 1.2
// rad the section has turned by √(1.2² + 0.1²), of which half counts as a deflection does.
TEST(ThirdOrderTerms, OfATwistedBodyThatBendsAreThoseOfHalfTheAngleSquared) {
  const TwistedAndBent beam;
  const double foreshortening = 2.0 / 3 * 0.05 * 0.05;
  EXPECT_NEAR(beam.share(0.05, 0), 0.05 * 0.05 + foreshortening * foreshortening, 1e-9);
  EXPECT_NEAR(beam.share(0.05, 1.2), (1.2 * 1.2 + 0.1 * 0.1) / 4, 1e-6);
  EXPECT_EQ(beam.share(0, 1.2), 0) << "a shaft that does not bend turns right at any angle";
}

/// A beam under a force and a moment about its axis at its tip, as of a spring that is wound up: by a rod of exact
/// kinematics its tip comes to rest at 0.0499 m, `quadratic` says 0.0578. Nothing is exact beside a plate, which rests.
SceneValues twisted_beam(const std::string& formulation, double torque) {
  SceneValues values = SceneValues::parse(R"(format: withy/1
gravity: [0, 0, 0]
time: {end: 1, output: 0.02}
integrator: {name: radau, rtol: 1e-6}
bodies:
  b: {type: beam, length: 1, mass_per_length: 1, damping_ratio: 0.3, bending_y: {stiffness: 20, modes: 3, family: orthogonal-polynomials}, bending_z: {stiffness: 20, modes: 3, family: orthogonal-polynomials}, torsion: {stiffness: 1, inertia: 0.01, modes: 3, family: orthogonal-polynomials}}
  arm: {type: rigid, mass: 0.1, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
  p: {type: plate, length: 0.1, width: 0.1, mass_per_area: 1, stiffness: 10}
hinges:
  rest: {type: weld, parent: world, child: p}
  r: {type: weld, parent: world, child: b}
  a: {type: weld, parent: b.tip, child: arm}
loads:
  t: {type: torque, frame: b.tip, value: [1, 0, 0], following: true}
  f: {type: force, frame: b.tip, value: [0, 0, 3]}
)",
                                          "twist.yaml");
  values.set("loads.t.value.0", Value(torque), "the test");
  values.choose_formulation(formulation, "the test");
  return values;
}

// At rest it is twisted by T L/GJ = 1.2 rad: half of that squared is 36 % and more, for it overshoots from its start.
TEST(ThirdOrderTerms, OfTwistAreInWhatACertificateSaysOfARunInSecondOrder) {
  const CertifiedRun twisted = run(prepare(twisted_beam("quadratic", 1.2), plugins()), plugins());
  EXPECT_GT(twisted.summary.peak_section_angle.at("b"), 1.2);
  EXPECT_LT(twisted.summary.peak_section_angle.at("b"), 2 * 1.2 + 0.1);
  EXPECT_LT(twisted.summary.peak_deflection_ratio.at("b"), 0.15);
  EXPECT_THAT(twisted.certificate.without_estimate, HasSubstr("a section of a bent body is turned by"));
  EXPECT_THAT(run(prepare(twisted_beam("quadratic", 0.01), plugins()), plugins()).certificate.without_estimate,
              HasSubstr("of a body's length"));
}

TEST(ThirdOrderTerms, OfTwistAreInWhatAChoiceOfFormulationsCanHold) {
  const CertifiedRun twisted = run(prepare(twisted_beam("auto", 1.2), plugins()), plugins());
  EXPECT_EQ(twisted.summary.status, RunStatus::inaccurate);
  EXPECT_THAT(twisted.summary.message, HasSubstr("Sections of a bent body that turn by"));
}

}  // namespace
}  // namespace withy::study
