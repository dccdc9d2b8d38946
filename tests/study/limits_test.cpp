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
  explicit Limited(const std::string& rest, bool look_beyond = false) {
    const Prepared prepared = prepare(SceneValues::parse("format: withy/1\n" + rest, "limited.yaml"), plugins());
    RunSettings settings;
    settings.look_beyond = look_beyond;
    const CertifiedRun done = run(prepared, plugins(), settings);
    summary = done.summary;
    all = indicators(prepared.scene, summary);
    certified = done.certificate.indicators;
  }
  /// The limit of which the text is; one of NaN where there is none.
  [[nodiscard]] Indicator of(const std::string& text) const {
    for (const Indicator& i : all)
      if (i.text.find(text) != std::string::npos) return i;
    return {text, NAN, NAN, ""};
  }
  RunSummary summary;
  std::vector<Indicator> all;
  std::vector<Indicator> certified;  ///< all that a certificate has
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

// T L/GJ = 0.5 rad of twist while it sags by little is beyond the 0.2 rad up to which angles are small; on a shaft that
// does not bend no angle is too great.
TEST(Limits, OfAnglesAreThoseOfSectionsOfBodiesThatBend) {
  const auto shaft = [](double force) {
    return Limited(
        "gravity: [0, 0, 0]\nformulation: quadratic\nintegrator: {name: radau, rtol: 1e-6}\n"
        "time: {end: 1, output: 0.1}\nbodies:\n  b: {type: beam, length: 1, mass_per_length: 1, "
        "bending_z: {stiffness: 20, modes: 2, family: orthogonal-polynomials}, torsion: {stiffness: 1, "
        "inertia: 0.01, modes: 2, family: orthogonal-polynomials}, damping_ratio: 0.3}\n"
        "hinges: {r: {type: weld, parent: world, child: b}}\nloads:\n  t: {type: torque, frame: b.tip, "
        "value: [0.5, 0, 0], following: true}\n  f: {type: force, frame: b.tip, value: [0, 0, " +
        std::to_string(force) + "]}\n");
  };
  const std::string words = "angle that the tip of 'b' turns by while it is bent";
  const Limited bent = shaft(1);
  EXPECT_LT(bent.of("tip deflection of 'b'").use(), 1);
  EXPECT_GT(bent.of(words).value, 0.5);
  EXPECT_LT(bent.of(words).value, 1.1) << "twice at most, and a slope of F L²/2EI";
  EXPECT_EQ(bent.of(words).limit, 0.2);
  EXPECT_GT(bent.of(words).use(), 1);
  EXPECT_TRUE(std::isnan(shaft(0).of(words).value));
}

// Opposite forces P at the corners of a free edge twist a plate by P L/(2 D (1 − ν)) where its root does not hold it
// from warping: its corners go 0.3 of its length here, somewhat less for the root; the middle of the edge rests.
TEST(Limits, OfDeflectionsOfAPlateAreThoseOfItsCornersToo) {
  const Limited twisted(R"(gravity: [0, 0, 0]
formulation: quadratic
integrator: {name: radau, rtol: 1e-6}
time: {end: 6, output: 0.1}
bodies:
  p: {type: plate, length: 1, width: 0.6, mass_per_area: 2.7, stiffness: 5, modes: 5, damping_ratio: 0.3}
hinges: {r: {type: weld, parent: world, child: p}}
loads:
  l: {type: force, frame: p.left, value: [0, 0, 7]}
  r: {type: force, frame: p.right, value: [0, 0, -7]}
)");
  const Indicator i = twisted.of("deflection of what moves most of the tip, left, right of 'p' over its length");
  EXPECT_GT(i.value, 0.2);
  EXPECT_LT(i.value, 2 * 0.3);
  EXPECT_GT(i.use(), 1);
  EXPECT_LT(twisted.summary.peak_deflection.at("p")[2], 1e-6) << "of the tip alone";
}

// In `ruthless` what lies between segments is truncated as what lies within them: the load of the whole counts, as of
// the beam in one piece of the same functions. Without truncation each segment's own does.
TEST(Limits, OfLoadsOfBodiesInSegmentsAreThoseOfTheWholeWhereKinematicsIsTruncated) {
  const auto spun = [](int segments, const std::string& formulation) {
    return Limited("formulation: " + formulation + R"(
gravity: [0, 0, 0]
integrator: {name: dopri5, rtol: 1e-7}
time: {end: 0.2}
bodies:
  b: {type: beam, length: 2, mass_per_length: 1, segments: )" +
                   std::to_string(segments) +
                   R"(, bending_y: {stiffness: 20, modes: 2, family: orthogonal-polynomials}}
hinges: {r: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}
motions: {m: {type: constant-rate, hinge: r, rate: 3}}
)");
  };
  const double whole = spun(1, "ruthless").of("load of 'b' over").value;
  EXPECT_GT(whole, 0.1);
  EXPECT_NEAR(spun(6, "ruthless").of("load of 'b' over").value, whole, 1e-3 * whole);
  EXPECT_TRUE(std::isnan(spun(6, "ruthless").of("load of 'b.1' over").value));
  EXPECT_LT(spun(6, "linear").of("load of 'b.1' over").value, 0.1 * whole);
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

// A cantilever that vibrates in its third mode alone, 54.53 rad/s: gauss with steps of 0.1 s keeps its energy, and the
// phase is any after a few steps. The lowest frequency, 3.1 rad/s, is followed.
TEST(Limits, OfFixedStepsAreThoseOfTheModeThatHasTheEnergy) {
  const std::string beam = R"(time: {end: 4, output: 0.1}
bodies: {b: {type: beam, length: 4, mass_per_length: 1, bending_y: {stiffness: 200, modes: 5, family: clamped-free}}}
hinges: {r: {type: weld, parent: world, child: b}}
initial: {bodies: {b: {modes: [0, 0, 0.01, 0, 0]}}}
)";
  const double third = std::pow(7.8547574 / 4, 2) * std::sqrt(200);
  const auto of = [&](const std::string& integrator) {
    const Limited run("integrator: " + integrator + "\n" + beam, true);
    EXPECT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
    for (const Indicator& i : run.certified)
      if (i.text.find("step times the frequency of what vibrates") == 0) return i;
    return Indicator{"", NAN, NAN, ""};
  };
  const Indicator coarse = of("{name: gauss, step: 0.1}");
  EXPECT_NEAR(coarse.value, 0.1 * third, 1e-3 * third * 0.1);
  EXPECT_GT(coarse.use(), 5);
  EXPECT_THAT(coarse.text, HasSubstr("54.5 rad/s, most of it b.bending_y[3]"));
  EXPECT_LT(of("{name: gauss, step: 0.01}").use(), 1);
  EXPECT_TRUE(std::isnan(of("{name: dopri5, rtol: 1e-6, atol: 1e-9}").value)) << "its steps are of its own choice";
}

// Between a pin and a roller the third vibration is sin 3πx/L, at 28.1 rad/s; of the tree with its loop cut it would be
// one of a beam whose tip is free, at 33 rad/s.
TEST(Limits, OfFixedStepsAreOfVibrationsThatKeepLoopsClosed) {
  const std::string beam = R"(time: {end: 4, output: 0.1}
bodies:
  b: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 0.1, modes: 4, family: pinned-pinned}}
  roller: {type: rigid, mass: 0.02}
hinges:
  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: b}
  slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: roller}
constraints: {loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: b.tip, b: roller}}
initial: {guess: {hinges: {slide: {position: 1}}}, bodies: {b: {modes: [0, 0, 0.001, 0]}}}
)";
  const double third = std::pow(3 * std::numbers::pi, 2) * std::sqrt(0.1);
  const auto of = [&](const std::string& step) {
    const Limited run("integrator: {name: gauss, step: " + step + "}\n" + beam, true);
    EXPECT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
    for (const Indicator& i : run.certified)
      if (i.text.find("step times the frequency of what vibrates") == 0) return i;
    return Indicator{"", NAN, NAN, ""};
  };
  const Indicator coarse = of("0.1");
  EXPECT_NEAR(coarse.value, 0.1 * third, 1e-3 * third * 0.1);
  EXPECT_THAT(coarse.text, HasSubstr("28.1 rad/s"));
  EXPECT_LT(of("0.01").use(), 1);
}

// A clamped beam of 157 rad/s that bends with a force of 1.57 rad/s, from where it is held at the start, in steps that
// are long beside its vibration and short beside the force: what an implicit integrator is for. Let go, it rings.
TEST(Limits, OfFixedStepsAreOfTheFrequencyOfTheMotionThatThereIs) {
  const std::string beam = R"(time: {end: 8, output: 0.1}
integrator: {name: gauss, step: 0.02}
bodies: {b: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 2000, modes: 1, family: clamped-free}}}
hinges: {r: {type: weld, parent: world, child: b}}
)";
  const auto of = [&](const std::string& rest) {
    const Limited run(beam + rest, true);
    EXPECT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
    for (const Indicator& i : run.certified)
      if (i.text.find("step times the frequency of what vibrates") == 0) return i;
    return Indicator{"", NAN, NAN, ""};
  };
  const double own = std::pow(1.8751041, 2) * std::sqrt(2000);
  EXPECT_NEAR(of("initial: {bodies: {b: {modes: [0.01]}}}").value, 0.02 * own, 1e-3 * own * 0.02);
  // 50 N (1 − cos ωt)
  const double followed = of(R"(loads:
  still: {type: force, frame: b.tip, value: [0, 50, 0]}
  sways: {type: force, frame: b.tip, law: sine, amplitude: [0, 50, 0], period: 4, phase: -1.5707963267948966}
)")
                              .value;
  EXPECT_LT(followed, 0.1) << "at 1.57 rad/s a step is 0.031";
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
