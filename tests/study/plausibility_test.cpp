/// \file
/// What in a scene is allowed, yet hardly meant.
#include "withy/study/plausibility.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "withy/tests/study/message.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;
using testing::Not;

std::vector<Remark> remarks_on_held(const std::string& body, const std::string& child,
                                    const std::string& hinge = "type: weld") {
  const SceneValues values =
      SceneValues::parse("format: withy/1\ntime: {end: 1}\nbodies: {p: " + body + "}\nhinges:\n  w: {" + hinge +
                             ", parent: world, child: " + child + "}\n",
                         "planted.yaml");
  return implausible(prepare(values, plugins()), plugins());
}

/// The sections of a beam are as good as its root, its functions are not: two of clamped-free, which have no moment at
/// the tip, vibrate clamped there at 9.34197 Hz, x² and x³ at 5.62252 (Ritz, by quadrature), the beam at 5.59591.
TEST(Plausibility, ABeamThatIsNotHeldAtItsRootByFunctionsMadeForThat) {
  const auto beam = [](const std::string& family) {
    return "{type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 100, modes: 2, family: " + family + "}}";
  };
  const std::vector<Remark> found = remarks_on_held(beam("clamped-free"), "p.tip");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].place.path, "/hinges/w");
  EXPECT_THAT(found[0].text, HasSubstr("2 bending_y modes of clamped-free vibrate first at 9.342 Hz, as many of "
                                       "orthogonal-polynomials at 5.623 Hz"));
  EXPECT_THAT(remarks_on_held(beam("clamped-free"), "p"), testing::IsEmpty());
  EXPECT_THAT(remarks_on_held(beam("orthogonal-polynomials"), "p.tip"), testing::IsEmpty());
  // About a pin there is no moment at the tip.
  EXPECT_THAT(remarks_on_held(beam("clamped-free"), "p.tip", "type: revolute, axis: [0, 0, 1]"), testing::IsEmpty());
  EXPECT_EQ(remarks_on_held(beam("clamped-free"), "p.tip", "type: revolute, axis: [0, 1, 0]").size(), 1u);
}

/// A boom of 1 kg and 4 m with 1.5 kg at its tip deflects by P L³/3EI + w L⁴/8EI. One clamped-free eigenfunction, of
/// β = 1.8751, φ(1) = 2 and ∫φ = 0.78299, leaves 4/β⁴ = 0.32357 of the third and 2 · 0.78299/β⁴ = 0.12667 of the
/// eighth, 2.1 % of the whole; two 0.4 %. One polynomial, a parabola, leaves a quarter of the third and is no remedy;
/// two leave nothing.
TEST(Plausibility, FunctionsWithoutAMomentAtALoadedTipAreHeldAgainstTheBeamItself) {
  const auto remarks = [](const std::string& bending) {
    const SceneValues values = SceneValues::parse(R"(format: withy/1
time: {end: 1}
bodies:
  boom: {type: beam, length: 4, mass_per_length: 0.25, )" +
                                                      bending + R"(}
  load: {type: rigid, mass: 1.5, inertia: [0.002, 0.002, 0.002, 0, 0, 0]}
hinges:
  root: {type: weld, parent: world, child: boom}
  mount: {type: weld, parent: boom.tip, child: load}
)",
                                                  "planted.yaml");
    return implausible(prepare(values, plugins()), plugins());
  };
  const std::string one = "bending_z: {stiffness: 60, modes: 1}";
  const std::vector<Remark> found = remarks(one);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].place.path, "/bodies/boom");
  EXPECT_THAT(found[0].text, HasSubstr("1 bending_z mode of clamped-free carries no moment at the tip"));
  EXPECT_NEAR(test::number_after(found[0].text, "it deflects "), 2.1, 0.05) << found[0].text;
  EXPECT_THAT(found[0].text, HasSubstr("choose 2 bending_z of family: orthogonal-polynomials"));
  EXPECT_THAT(remarks("bending_z: {stiffness: 60, modes: 2}"), testing::IsEmpty());
  EXPECT_THAT(remarks("bending_z: {stiffness: 60, modes: 2, family: orthogonal-polynomials}"), testing::IsEmpty());
  // Strains that are off are named alone.
  const std::vector<Remark> mixed = remarks("bending_y: {stiffness: 60, modes: 2}, " + one);
  ASSERT_EQ(mixed.size(), 1U);
  EXPECT_EQ(mixed[0].text, found[0].text);
}

/// Functions of a pinned root have no moment at a welded one: seen from it, two of pinned-pinned, sin kπx − kπx,
/// vibrate first at 6.73793 Hz (Ritz, by quadrature), x² and x³ at 5.62252.
TEST(Plausibility, ABeamThatIsClampedAtItsRootByFunctionsOfAPinnedOne) {
  const auto beam = [](const std::string& family) {
    return "{type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 100, modes: 2, family: " + family + "}}";
  };
  const std::vector<Remark> found = remarks_on_held(beam("pinned-pinned"), "p");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].place.path, "/hinges/w");
  EXPECT_THAT(found[0].text, HasSubstr("2 bending_y modes of pinned-pinned vibrate first at 6.738 Hz, as many of "
                                       "orthogonal-polynomials at 5.623 Hz"));
  for (const char* family : {"pinned-free", "free-free"})
    EXPECT_EQ(remarks_on_held(beam(family), "p").size(), 1u) << family;
  // A pin about the axis of bending is what they are made for.
  EXPECT_THAT(remarks_on_held(beam("pinned-pinned"), "p", "type: revolute, axis: [0, 0, 1]"), testing::IsEmpty());
  EXPECT_EQ(remarks_on_held(beam("pinned-pinned"), "p", "type: prismatic, axis: [1, 0, 0]").size(), 1u);
}

/// Places of what looks like degrees.
std::vector<std::string> places_of_degrees(const std::string& rest) {
  const SceneValues values = SceneValues::parse(R"(format: withy/1
time: {end: 1}
bodies:
  a: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  b: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  c: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  pin: {type: revolute, axis: [0, 0, 1], parent: a, child: b}
  slide: {type: prismatic, axis: [0, 0, 1], parent: world, child: c}
)" + rest,
                                                "planted.yaml");
  std::vector<std::string> places;
  for (const Remark& r : implausible(prepare(values, plugins()), plugins()))
    if (r.text.find("are degrees meant?") != std::string::npos) places.push_back(r.place.path);
  return places;
}

TEST(Plausibility, DegreesThatAHingeIsToTakeAreNoticedWhereverTheyStand) {
  EXPECT_THAT(places_of_degrees(R"(loads:
  held: {type: pid, hinge: axle, proportional: 1, reference: 30}
  curve: {type: pid, of: axle, to: nothing, proportional: 1, reference: [[0, 0], [1, 45], [2, 90]]}
  led: {type: pid, hinge: axle, proportional: 1, motion: {type: quintic, to: 90, duration: 1}}
  jets: {type: hinge-relay, hinge: axle, effort: 1, on: 10, off: 5}
  servo: {type: pd-controller, law: sine, period: 1, hinges: {axle: {amplitude: 30, stiffness: 1, damping: 1}}}
motions:
  swing: {type: sine, hinge: pin, amplitude: 20, period: 1}
events:
  passed: {hinge: axle, value: 90}
)"),
              testing::ElementsAre("/loads/held/reference", "/loads/curve/reference/1/1", "/loads/led/motion/to",
                                   "/loads/jets/on", "/loads/servo/hinges/axle/amplitude", "/motions/swing/amplitude",
                                   "/events/passed/value"));
}

/// Lengths, efforts, rates, turns that are no multiple of five, and units.
TEST(Plausibility, WhatIsNoAngleOrMeantInRadiansIsNotTakenForDegrees) {
  EXPECT_THAT(places_of_degrees(R"(loads:
  far: {type: pid, hinge: slide, proportional: 1, reference: 30}
  torque: {type: hinge-effort, hinge: axle, law: sine, amplitude: 30, period: 1}
  turns: {type: pid, hinge: axle, proportional: 1, reference: [[0, 0], [1, 45.5], [2, 90]]}
  fast: {type: pid, of: axle.rate, hinge: axle, proportional: 1, reference: 30}
  written: {type: pid, hinge: axle, proportional: 1, reference: 30 deg}
events:
  spun: {hinge: axle, of: rate, value: 90}
)"),
              testing::IsEmpty());
}

/// d = 10 on h = 0.001 kg m² beside k = 100: ten times critical is 20 √(k h) = 6.3, and the pole −d/h = −10000/s.
TEST(Plausibility, APidThatDrivesNextToNoInertiaIsNoticed) {
  const auto said = [](const std::string& more) {
    const SceneValues values = SceneValues::parse(R"(format: withy/1
time: {end: 0.01}
bodies: {wheel: {type: rigid, mass: 1, inertia: [0.001, 0.001, 0.001, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {servo: {type: pid, hinge: axle, proportional: 100, )" +
                                                      more + "}}\n",
                                                  "planted.yaml");
    std::string all;
    for (const Remark& r : implausible(prepare(values, plugins()), plugins())) all += r.place.path + ": " + r.text;
    return all;
  };
  EXPECT_THAT(said("derivative: 10"), HasSubstr("/loads/servo: the servo on 'axle' drives an inertia of 0.001 alone"));
  EXPECT_THAT(said("derivative: 6"), Not(HasSubstr("drives an inertia")));
  EXPECT_THAT(said("derivative: 10, filter: 0.1"), Not(HasSubstr("drives an inertia"))) << "no such pole";
}

/// All that is said of a scene, with places.
std::string implausible_in(const std::string& scene) {
  std::string all;
  for (const Remark& r :
       implausible(prepare(SceneValues::parse("format: withy/1\n" + scene, "planted.yaml"), plugins()), plugins()))
    all += r.place.path + ": " + r.text + "\n";
  return all;
}

/// Of 0.9 m beside 1200 m, typed in millimetres, nobody knows which is wrong; of bodies far apart no other is named.
TEST(Plausibility, TheBodyThatMakesATreeLargeIsNamedWithTheShortOne) {
  const auto said = [](const std::string& upper, const std::string& hinge) {
    return implausible_in(
        "time: {end: 1}\nbodies:\n  upper: " + upper +
        "\n  fore: {type: beam, length: 0.9, mass_per_length: 1, bending_y: {stiffness: 40, modes: 1, "
        "family: orthogonal-polynomials}}\nhinges:\n  root: {type: weld, parent: world, child: upper}\n"
        "  elbow: {type: weld, child: fore, parent: " +
        hinge + "}\n");
  };
  const std::string beam =
      "{type: beam, mass_per_length: 1, bending_y: {stiffness: 90, modes: 1, family: orthogonal-polynomials}, length: ";
  EXPECT_THAT(said(beam + "1200}", "upper.tip"),
              HasSubstr("/bodies/fore: a flexible body 0.9 m long in a tree of 1201 m, most of it 'upper' with 1200 m; "
                        "are both in metres?"));
  EXPECT_THAT(said(beam + "1.2}", "upper.tip"), Not(HasSubstr("in a tree of")));
  EXPECT_THAT(said("{type: rigid, mass: 1}", "upper, offset: {position: [1000, 0, 0]}"),
              HasSubstr("a flexible body 0.9 m long in a tree of 1001 m; is the length in metres?"));
}

TEST(Plausibility, AnInertiaWithoutAMassIsNoticed) {
  const auto said = [](const std::string& body) {
    return implausible_in("time: {end: 1}\nbodies: {base: {type: rigid, " + body +
                          "}}\nhinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: base}}\n");
  };
  EXPECT_THAT(said("mass: 0, inertia: [4, 4, 5, 0, 0, 0]"), HasSubstr("/bodies/base: an inertia and a mass of 0 kg"));
  EXPECT_THAT(said("mass: 1, inertia: [4, 4, 5, 0, 0, 0]"), testing::IsEmpty());
}

/// A mass on a spring at 10 rad/s: rk4 lets it grow from steps of 2 √2 / 10 s on.
TEST(Plausibility, FixedStepsBeyondWhatTheIntegratorIsStableToAreNoticed) {
  const auto said = [](const std::string& integrator) {
    return implausible_in("time: {end: 100}\nintegrator: " + integrator +
                          "\nbodies: {cart: {type: rigid, mass: 1}}\n"
                          "hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}\n"
                          "loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 100}}\n");
  };
  EXPECT_THAT(said("{name: rk4, step: 0.35}"),
              testing::AllOf(HasSubstr("/integrator/step: steps of 0.35 s are 1.23"), HasSubstr("at most 0.28")));
  EXPECT_THAT(said("{name: rk4, step: 0.28}"), testing::IsEmpty());
  EXPECT_THAT(said("{name: gauss, step: 0.35}"), testing::IsEmpty());
  EXPECT_THAT(said("{name: dopri5}"), testing::IsEmpty());
}

}  // namespace
}  // namespace withy::study
