// What hangs at a beam's tip, as its functions know it: against closed forms, and by how much faster they converge.
#include "withy/study/tip_load.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "withy/study/candidates.hpp"
#include "withy/study/probe.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

constexpr double mass = 2, inertia = 0.05, arm = 0.3;

/// A boom with a body at its tip, whose centre of mass is 0.3 m out along the body's own x.
Prepared boom(const std::string& hinge, const std::string& more = "") {
  const std::string text =
      "format: withy/1\ntime: {end: 1}\nbodies:\n"
      "  boom: {type: beam, length: 1.5, mass_per_length: 0.4, bending_y: {stiffness: 20, modes: 2}, bending_z: "
      "{stiffness: 20, modes: 2}, torsion: {stiffness: 9, inertia: 0.001, modes: 1}}\n"
      "  load: {type: rigid, mass: 2, center_of_mass: [0.3, 0, 0], inertia: [0.01, 0.05, 0.05, 0, 0, 0]}\n"
      "hinges:\n  root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}\n"
      "  joint: {" +
      hinge + ", parent: boom.tip, child: load}\n" + more;
  return prepare(SceneValues::parse(text, "boom.yaml"), plugins());
}

Value family(const Prepared& scene, const std::string& strain) {
  const auto b = static_cast<std::size_t>(scene.model().body("boom"));
  return *loaded_family(tip_loads(scene.model(), scene.scene.initial)[b], strain, vibration_modes, false);
}

void expect_load(const Value& family, double mass_of, double offset, double central) {
  EXPECT_NEAR(family.number_at("tip_mass"), mass_of, 1e-5 * mass);
  EXPECT_NEAR(family.number_at("tip_offset"), offset, 1e-5 * arm);
  EXPECT_NEAR(family.number_at("tip_inertia"), central, 1e-5 * inertia);
}

TEST(TipLoad, AWeldedBodyIsThere) {
  const Prepared scene = boom("type: weld");
  expect_load(family(scene, "bending_y"), mass, arm, inertia);
  expect_load(family(scene, "bending_z"), mass, arm, inertia);
  expect_load(family(scene, "torsion"), 0, 0, 0.01);
  expect_load(family(scene, "extension"), mass, 0, 0);
  EXPECT_FALSE(loaded_family(Matrix6::Identity(), "breathing", vibration_modes, false)) << "not a strain of a beam";
}

/// A body on a pin acts along its arm with its whole mass, across with m J/(J + m c²), and takes no moment.
TEST(TipLoad, ABodyOnAPinActsAsItsArmLies) {
  const double across = mass * inertia / (inertia + mass * arm * arm);
  for (const double angle : {0.0, 30.0, 90.0, 200.0}) {
    const Prepared scene = boom("type: revolute, axis: [0, 0, 1]",
                                "initial: {hinges: {joint: {position: " + std::to_string(angle) + " deg}}}\n");
    const double s = std::sin(angle * std::numbers::pi / 180), c = std::cos(angle * std::numbers::pi / 180);
    expect_load(family(scene, "bending_y"), mass * s * s + across * c * c, 0, 0);
  }
}

/// A pin that fills the column of H that it is given, and does not make it.
class BarePin final : public Hinge {
 public:
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double> x, std::span<const double>, HingeMotion& out) const noexcept override {
    out.pose.R = Eigen::AngleAxisd(x[0], Vector3::UnitZ()).toRotationMatrix();
    if (out.H.cols() == 1) out.H.col(0) = Vector6::Unit(2);
    out.bias.setZero();
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override { return {}; }
};

TEST(TipLoad, AHingeIsGivenTheColumnsThatItFills) {
  const Prepared scene = boom("type: revolute, axis: [0, 0, 1]");
  std::vector<HingeNode> hinges = scene.model().hinges();
  hinges.back().hinge = std::make_shared<BarePin>();
  const Model bare(scene.model().bodies(), hinges, Vector3::Zero());
  const auto b = static_cast<std::size_t>(bare.body("boom"));
  const Matrix6 load = tip_loads(bare, scene.scene.initial)[b];
  EXPECT_TRUE(load.isApprox(tip_loads(scene.model(), scene.scene.initial)[b], 1e-12));
}

/// A drive of inertia r behind a gear shares what the pin lets go: with a = J + m c² the tip feels J + m c² as a r/(a +
/// r) and the mass as m − m² c²/(a + r); without a drive neither, with an endless one the body is welded.
TEST(TipLoad, ABodyOnAGearedPinIsHeldByItsDrive) {
  const double a = inertia + mass * arm * arm, first = mass * arm;
  for (const double r : {0.0, 0.01, 0.2, 300.0}) {
    const Prepared scene = boom("type: revolute, axis: [0, 0, 1], reflected_inertia: " + std::to_string(r));
    const double m = mass - first * first / (a + r), s = first * r / (a + r), about = a * r / (a + r);
    expect_load(family(scene, "bending_y"), m, s / m, about - s * s / m);
    expect_load(family(scene, "bending_z"), mass, arm, inertia);
  }
}

TEST(TipLoad, AHingeThatAMotionDrivesHolds) {
  const Prepared scene = boom("type: revolute, axis: [0, 0, 1]",
                              "motions: {turn: {type: spin-up, hinge: joint, rate: 1, duration: 0.5}}\n");
  expect_load(family(scene, "bending_y"), mass, arm, inertia);
}

/// What slides across has no mass there; its inertia turns with the tip all the same.
TEST(TipLoad, WhatSlidesAcrossIsNotMovedAcross) {
  const Prepared scene = boom("type: prismatic, axis: [0, 1, 0]");
  expect_load(family(scene, "bending_y"), 0, 0, inertia);
  expect_load(family(scene, "bending_z"), mass, arm, inertia);
}

/// What rounding leaves of a moment is no offset: it is written into scenes.
TEST(TipLoad, ABodyOnAPinHasNoOffset) {
  for (double angle = 1; angle < 180; angle += 7) {
    const Prepared scene = boom("type: revolute, axis: [0, 0, 1]",
                                "initial: {hinges: {joint: {position: " + std::to_string(angle) + " deg}}}\n");
    EXPECT_EQ(family(scene, "bending_y").number_at("tip_offset"), 0) << angle;
  }
}

TEST(TipLoad, ABeamThatCarriesNothingKeepsAFreeTip) {
  const Prepared scene =
      prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/gallery/spinning-beam.yaml"), plugins());
  for (const Matrix6& load : tip_loads(scene.model(), scene.scene.initial)) {
    EXPECT_TRUE(load.isZero(0));
    for (const char* name : {loaded_modes, vibration_modes})
      EXPECT_EQ(loaded_family(load, "bending_y", name, false)->text(), "clamped-free");
    EXPECT_EQ(loaded_family(load, "bending_y", vibration_modes, true)->text(), vibration_modes);
  }
  for (const std::string& name : candidates_for(scene, plugins(), usual_axes()).families)
    EXPECT_NE(name, vibration_modes);
}

/// Chains hang on from tip to tip: the first link carries what lies beyond its elbow.
TEST(TipLoad, EachBodyOfASceneGetsItsOwn) {
  const Prepared arm = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml"), plugins());
  std::map<std::string, double> masses;
  for (const Change& change : changes_at(arm.scene, {"quadratic", vibration_modes, 2, "", 0, {}, {}}, plugins()))
    if (change.path.ends_with("family")) masses[change.path] = change.value.number_at("tip_mass");
  ASSERT_EQ(masses.size(), 2U);
  EXPECT_DOUBLE_EQ(masses.at("bodies.link2.bending_y.family"), 2) << "the payload";
  EXPECT_GT(masses.at("bodies.link1.bending_y.family"), 14) << "the elbow's body";
  EXPECT_LT(masses.at("bodies.link1.bending_y.family"), 14 + 0.62 + 2) << "with a part of what the elbow lets go";
}

TEST(TipLoad, FunctionsThatKnowTheLoadConvergeFaster) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  const Prepared scene = prepare(values.set("time.end", Value(0.5), "the test"), plugins());
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 5, "dop853", 1e-8, {}, {}};
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  const Reference truth = *find_reference(at, plugins(), outputs, goal, {}).reference;
  const Yardstick yardstick{truth, truth.scales};
  const auto off = [&](const char* name) {
    return evaluator.run({truth.point.formulation, name, 2, "dop853", 1e-8, {}, {}}, yardstick).use;
  };
  EXPECT_LT(off(loaded_modes), 0.1 * off("clamped-free"));
}

}  // namespace
}  // namespace withy::study
