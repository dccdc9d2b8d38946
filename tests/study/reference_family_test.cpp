// Which family of modes a reference has.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/advice.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

/// The beam that spins carries nothing; polynomials leave what its first eigenfunction has at the start to fast modes.
TEST(FindReference, EigenfunctionsAreTakenForABareBeamWhereTheyConvergeFaster) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/gallery/spinning-beam.yaml");
  const Prepared beam = prepare(values.set("time.end", Value(0.5), "the test"), plugins());
  EXPECT_FALSE(reference_families(candidates_for(beam, plugins(), usual_axes()), beam).others.empty());
  const Outputs outputs = Outputs::all(beam.model());
  Evaluator evaluator(beam, plugins(), outputs, {});
  const auto family = [&](std::vector<std::string> families) {
    ReferenceGoal goal;
    goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-5, {}, {}};
    goal.families = std::move(families);
    const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
    goal.levels = 1;
    goal.enough = [](const Reference&) { return true; };
    return find_reference(at, plugins(), outputs, goal, {}).reference->point.family;
  };
  EXPECT_EQ(family({"", "orthogonal-polynomials"}), "");
  EXPECT_EQ(family({"craig-bampton"}), "orthogonal-polynomials") << "not clearly better";
  EXPECT_EQ(family({}), "orthogonal-polynomials");
}

/// The third mode changes less in functions that know what the tips carry, and all that follow less in polynomials: the
/// elbow's spring gives a moment that those do not have.
TEST(FindReference, AFamilyWhoseSeriesTurnsOutSlowIsLeft) {
  const Prepared arm = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/commanded-arm.yaml"), plugins());
  const Outputs outputs = Outputs::all(arm.model());
  Evaluator evaluator(arm, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  const auto found = [&](std::vector<std::string> families) {
    ReferenceGoal goal;
    goal.first = {"", "clamped-loaded", 2, "radau", 1e-4, {}, {}};
    goal.families = std::move(families);
    goal.levels = 14;
    goal.finer = 1;
    goal.leaps = true;
    goal.steady = [](const Reference&) { return true; };
    goal.enough = [](const Reference& r) { return r.point.modes >= 12; };
    return *find_reference(at, plugins(), outputs, goal, {}).reference;
  };
  const Reference slow = found({}), fast = found({"orthogonal-polynomials"});
  EXPECT_EQ(slow.point.family, "clamped-loaded");
  EXPECT_EQ(fast.point.family, "orthogonal-polynomials");
  EXPECT_EQ(fast.point.modes, 12);
  EXPECT_LT(relative_error(fast.own, fast.scales), 0.5 * relative_error(slow.own, slow.scales));
  const Distances apart = distances(outputs, slow.readings, fast.readings).first;
  for (std::size_t k = 0; k < apart.size(); ++k)
    EXPECT_LE(apart[k], slow.own[k] + fast.own[k]) << outputs.list()[k].label;
}

/// With five and six modes that know what the booms carry steps are as large as with four, and with eight a twentieth
/// of that: polynomials, which were left with four, look the better with six.
TEST(FindReference, AFamilyThatWasLeftDoesNotComeBackForOneLook) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spacecraft.yaml");
  const Prepared craft = prepare(values.set("time.end", Value(1.0), "the test"), plugins());
  const Outputs outputs(craft.model());
  Evaluator evaluator(craft, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "imex", 1e-2, {}, {}};
  goal.families = {"clamped-loaded"};
  goal.levels = 14;
  goal.finer = 1;
  goal.leaps = true;
  goal.steady = [](const Reference&) { return true; };
  goal.enough = [](const Reference& r) { return r.point.modes >= 8; };
  const Reference found = *find_reference(at, plugins(), outputs, goal, {}).reference;
  EXPECT_EQ(found.point.family, "clamped-loaded");
  EXPECT_LT(relative_error(found.own, found.scales), 0.01);
}

/// The slew's links carry an elbow and a payload.
Prepared arm_for(double seconds) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  return prepare(values.set("time.end", Value(seconds), "the test"), plugins());
}

TEST(FindReference, WhereATipCarriesABodyItsStaticShapesAreTakenOrFunctionsThatKnowTheBody) {
  const Prepared arm = arm_for(0.5);
  const ReferenceFamilies families = reference_families(candidates_for(arm, plugins(), usual_axes()), arm);
  EXPECT_EQ(families.first, "craig-bampton");
  EXPECT_EQ(families.others, std::vector<std::string>{"clamped-loaded"});
}

/// By ten polynomials, which are no kin of static shapes. The fastest frequency of n polynomials grows like n⁴, of
/// shapes and modes with a fixed tip like n²; explicit steps follow it.
TEST(FindReference, UnderALoadedTipStaticShapesAreNearerTheTruthThanAsManyPolynomialsInFewerSteps) {
  const Prepared arm = arm_for(0.2);
  const Outputs outputs = Outputs::all(arm.model());
  Evaluator evaluator(arm, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  const auto run = [&](const char* family, int modes) {
    ReferenceGoal goal;
    goal.first = {"", family, modes, "dop853", 1e-7, {}, {}};
    return *find_reference(at, plugins(), outputs, goal, {}).reference;
  };
  const Reference truth = run("orthogonal-polynomials", 10);
  for (const int modes : {6, 8}) {
    const Reference shapes = run("craig-bampton", modes), polynomials = run("orthogonal-polynomials", modes);
    const auto error = [&](const Reference& r) {
      return relative_error(distances(outputs, r.readings, truth.readings).first, truth.scales);
    };
    EXPECT_LT(error(shapes), error(polynomials)) << modes;
    EXPECT_LT(shapes.walk.evaluations, polynomials.walk.evaluations) << modes;
  }
}

/// A blade's stiffness goes over five decades, and its curvature has the kinks of that.
TEST(FindReference, WhereABeamVariesItsOwnModesAreNearerTheTruthThanAsManyPolynomials) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/gallery/wind-turbine-blade.yaml");
  for (const char* strain : {"bending_y", "bending_z"})
    values.set(std::string("bodies.blade.") + strain + ".family", Value(std::string("clamped-free")), "the test");
  const Prepared blade = prepare(values.set("time.end", Value(0.3), "the test"), plugins());
  const ReferenceFamilies families = reference_families(candidates_for(blade, plugins(), usual_axes()), blade);
  EXPECT_EQ(families.first, "vibration-modes");
  EXPECT_TRUE(std::count(families.others.begin(), families.others.end(), "orthogonal-polynomials"));
  const Outputs outputs = Outputs::all(blade.model());
  Evaluator evaluator(blade, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "vibration-modes", 5, "dop853", 1e-7, {}, {}};
  const Reference truth = *find_reference(at, plugins(), outputs, goal, {}).reference;
  const Yardstick yardstick{truth, truth.scales};
  const auto off = [&](const char* name) {
    return evaluator.run({truth.point.formulation, name, 3, "dop853", 1e-7, {}, {}}, yardstick).use;
  };
  EXPECT_LT(off("vibration-modes"), 0.2 * off("orthogonal-polynomials"));
}

}  // namespace
}  // namespace withy::study
