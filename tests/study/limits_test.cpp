// The limits that a certificate holds a run against, in scenes of which one is known to be passed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/study/indicators.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

struct Limited {
  explicit Limited(const std::string& rest) {
    const Prepared prepared = prepare(SceneValues::parse("format: withy/1\n" + rest, "limited.yaml"), plugins());
    RunSettings settings;
    settings.look_beyond = false;
    summary = run(prepared, plugins(), settings).summary;
    all = indicators(prepared.scene, summary);
  }
  /// The limit of which the text is; one of NaN where there is none.
  [[nodiscard]] Indicator of(const std::string& text) const {
    for (const Indicator& i : all)
      if (i.text.find(text) != std::string::npos) return i;
    return {text, NAN, NAN, ""};
  }
  RunSummary summary;
  std::vector<Indicator> all;
};

std::string sagging(const std::string& gravity, const std::string& formulation) {
  return "gravity: [0, " + gravity + ", 0]\nformulation: " + formulation + R"(
integrator: {name: dopri5, rtol: 1e-6, atol: 1e-9}
time: {end: 3, output: 0.1}
bodies:
  beam: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 0.1, modes: 3, family: pinned-pinned}, damping: {stiffness_proportional: 0.03 s}}
  roller: {type: rigid, mass: 0.02}
hinges:
  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: roller}
constraints: {loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: beam.tip, b: roller}}
initial: {guess: {hinges: {slide: {position: 1}}}}
)";
}

// A beam between a pin and a roller sags by 5 w L⁴ / (384 EI) in the middle, 0.13 of its length for w = 1 N/m; its tip
// stays where it is in the beam's own frame.
TEST(Limits, OfDeflectionsAreLookedAtWhereABeamBends) {
  const Limited sags(sagging("-1", "linear"));
  EXPECT_EQ(sags.summary.status, RunStatus::completed);
  const Indicator i = sags.of("deflection of the section at 50 % of the length of 'beam'");
  EXPECT_GT(i.value, 5.0 / 384 / 0.1) << "it falls from straight, and overshoots";
  EXPECT_LT(i.value, 2.1 * 5.0 / 384 / 0.1);
  EXPECT_GT(i.use(), 1);
  const Limited breaks(sagging("-20", "linear"));
  EXPECT_EQ(breaks.summary.status, RunStatus::diverged);
  EXPECT_THAT(breaks.summary.message, HasSubstr("the section at 50 % of the length of 'beam' is deflected by"));
}

// With one mode of 58 rad/s a step of 0.1 s has hardly a period of it; energy and stability do not tell.
TEST(Limits, OfFixedStepsAreThoseOfTheLowestVibrations) {
  const std::string boom = R"(time: {end: 2, output: 0.1}
bodies:
  hub: {type: rigid, mass: 3, inertia: [0.5, 0.5, 0.5, 0, 0, 0]}
  arm: {type: beam, length: 1.5, mass_per_length: 0.4, bending_y: {stiffness: 300, modes: 1}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  mount: {type: weld, parent: hub, child: arm}
initial: {hinges: {axle: {rate: [0.5]}}, bodies: {arm: {modes: [0.02]}}}
)";
  const double first = std::pow(1.8751 / 1.5, 2) * std::sqrt(300 / 0.4);
  const std::string words = "step times the lowest frequency of 'arm'";
  const Limited coarse("integrator: {name: gauss, step: 0.1}\n" + boom);
  EXPECT_EQ(coarse.summary.status, RunStatus::completed);
  EXPECT_NEAR(coarse.of(words).value, 0.1 * first, 1e-3 * first);
  EXPECT_EQ(coarse.all.front().text, words);
  EXPECT_LT(Limited("integrator: {name: gauss, step: 0.01}\n" + boom).of(words).use(), 1);
  EXPECT_TRUE(std::isnan(Limited("integrator: {name: dopri5, rtol: 1e-6, atol: 1e-9}\n" + boom).of(words).value));
}

// What a plate bends like is not said: the stricter of both limits holds, that of bending across the plane of rotation.
TEST(Limits, OfRatesAreThoseAcrossThePlaneUnlessABeamBendsInIt) {
  const std::string rest = R"(
hinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: blade}}
motions: {spin: {type: constant-rate, hinge: axle, rate: 0.2}}
formulation: ruthless
integrator: {name: dopri5, rtol: 1e-6, atol: 1e-9}
time: {end: 1}
)";
  const Limited plate(
      "bodies: {blade: {type: plate, length: 2, width: 0.5, mass_per_area: 2, stiffness: 20, modes: 3}}" + rest);
  EXPECT_EQ(plate.of("rate of 'blade'").limit, 0.13);
  const Limited beam(
      "bodies: {blade: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 20, modes: 1}}}" + rest);
  EXPECT_EQ(beam.of("rate of 'blade'").limit, 0.325);
}

}  // namespace
}  // namespace withy::study
