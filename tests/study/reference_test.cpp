// How a reference is found within a time, and what a higher formulation adds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/study/advice.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/tests/study/plugins.hpp"

namespace withy::study {
namespace {

using test::plugins;

Prepared soft_pendulum() {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/gallery/flexible-pendulum.yaml");
  return prepare(values.set("time.end", Value(0.4), "the test"), plugins());
}

/// Eigenfunctions of the bare beam carry no moment where the tip carries a body: they converge like 1/n, and what the
/// last mode changed is a fraction of what is missing. Polynomials converge fast.
TEST(FindReference, ALevelIsNoFurtherFromAMuchFinerReferenceThanItSaysOrTwiceThat) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  const Prepared scene = prepare(values.set("time.end", Value(0.5), "the test"), plugins());
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  const auto levels = [&](const char* family, int most) {
    std::vector<Reference> all;
    ReferenceGoal goal;
    goal.first = {"", family, 2, "dop853", 1e-8, {}, {}};
    goal.levels = most - 2;
    goal.finer = 1;
    goal.enough = [&](const Reference& r) { return all.push_back(r), r.point.modes >= most; };
    static_cast<void>(find_reference(at, plugins(), outputs, goal, {}));
    return all;
  };
  const std::vector<Reference> polynomials = levels("orthogonal-polynomials", 7), waves = levels("clamped-free", 7);
  const Reference& truth = polynomials.back();
  const auto held = [&](const Reference& r, double times) {
    const Distances off = distances(outputs, r.readings, truth.readings).first;
    for (std::size_t k = 0; k < off.size(); ++k) {
      // Below this it is integration that is seen.
      EXPECT_LE(off[k], times * r.own[k] + truth.own[k] + 1e-6 * r.scales[k])
          << r.text() << ": " << outputs.list()[k].label;
    }
    return relative_error(off, r.scales);
  };
  for (std::size_t i = 0; i + 2 < polynomials.size(); ++i) held(polynomials[i], 1);
  for (const Reference& r : waves) held(r, 2);
  EXPECT_LT(held(waves.back(), 2), 0.5 * held(waves.front(), 2));
}

/// What integration may add is told in advance; the tolerance is found for it, whatever the first one was.
TEST(FindReference, TheToleranceOfItsLevelsIsTheOneAtWhichIntegrationAddsWhatItMay) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  const Prepared scene = prepare(values.set("time.end", Value(0.5), "the test"), plugins());
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  constexpr double allowed = 1e-5;
  const auto found = [&](double first, bool measured) {
    ReferenceGoal goal;
    goal.first = {"", "orthogonal-polynomials", 2, "dop853", first, {}, {}};
    goal.finer = 1;
    if (measured) goal.integration = [](const Reference& r) { return relative_error(r.own, r.scales) / allowed; };
    return *find_reference(at, plugins(), outputs, goal, {}).reference;
  };
  const Reference exact = found(1e-9, false);
  for (const double first : {1e-4, 1e-6}) {
    const Reference r = found(first, true);
    EXPECT_GT(r.point.tolerance, exact.point.tolerance) << "no more than is needed";
    const double added = relative_error(distances(outputs, r.readings, exact.readings).first, exact.scales);
    EXPECT_LT(added, 10 * allowed) << r.text();
  }
}

/// The fourth mode of the plate twists it and is not excited, the fifth bends it again.
TEST(FindReference, AModeThatTheMotionDoesNotExciteIsNotTakenForTheEndOfTheSeries) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/gallery/spinning-plate.yaml");
  const Prepared plate = prepare(values.set("time.end", Value(3.0), "the test"), plugins());
  EXPECT_GT(kinds_of_modes(plate.scene), 1);
  const Outputs outputs = Outputs::all(plate.model());
  Evaluator evaluator(plate, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  constexpr double asked = 1e-3;
  const auto to = [&](int kinds, int least) {
    ReferenceGoal goal;
    goal.first = {"", "", 2, "dop853", 1e-6, {}, {}};
    goal.levels = 8;
    goal.kinds = kinds;
    // What the plate's kinematics lacks is in all of them.
    goal.enough = [&](const Reference& r) {
      return r.point.modes >= least && relative_error(r.own, r.scales) - r.third_order <= asked;
    };
    return *find_reference(at, plugins(), outputs, goal, {}).reference;
  };
  const Reference truth = to(3, 9);
  const auto wrong = [&](const Reference& r) {
    return relative_error(distances(outputs, r.readings, truth.readings).first, truth.scales);
  };
  EXPECT_LE(wrong(to(kinds_of_modes(plate.scene), 2)), asked);
  EXPECT_GT(wrong(to(1, 2)), asked) << "the last change alone says less than what is missing";
}

TEST(CorrectedReadings, PutADifferenceOnTopOfNumbersVectorsAndOrientations) {
  const Prepared scene = prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/spacecraft.yaml"), plugins());
  const Outputs outputs = Outputs::all(scene.model());
  const auto reading = [&](double angle, double x) {
    std::vector<double> r(outputs.size(), x);
    for (const Output& o : outputs.list()) {
      if (o.shape != Output::Shape::orientation) continue;
      r[o.at] = std::cos(0.5 * angle), r[o.at + 1] = r[o.at + 2] = 0, r[o.at + 3] = std::sin(0.5 * angle);
    }
    return r;
  };
  const Readings a{{0}, {reading(0.7, 3)}}, b{{0}, {reading(0.25, 1.5)}}, c{{0}, {reading(0.2, 1)}},
      sum{{0}, {reading(0.75, 3.5)}};
  const Distances off = distances(outputs, corrected(outputs, a, b, c), sum).first;
  for (std::size_t i = 0; i < off.size(); ++i) EXPECT_LT(off[i], 1e-7) << outputs.list()[i].label;
}

/// Modes of the lower rung cost more and more, where a level of the higher one may end the search: unless what that
/// adds has hardly changed.
TEST(FindReference, ModesOfALowerRungWaitForTheNextLevelWhereTheyCostMoreThanThat) {
  SceneValues values = SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/two-link-slew.yaml");
  const Prepared scene = prepare(values.set("time.end", Value(0.5), "the test"), plugins());
  const Outputs outputs = Outputs::all(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-6, {}, {}};
  goal.levels = 6;
  goal.finer = 1;
  double added = 0, known = 0, level = 0, spent = 0;
  goal.steady = [&](const Reference& r) { return added = relative_error(r.own, r.scales), true; };
  int lower_modes = 0;  // that were looked at
  goal.enough = [&](const Reference& r) {
    if (!r.added_by) {
      level = r.walk.seconds, spent = 0;
    } else if (r.point.modes > lower_modes) {
      EXPECT_TRUE(spent <= 2 * level || added < 0.25 * known) << "before " << r.text();
      spent += r.walk.seconds;
      lower_modes = r.point.modes;
    }
    known = relative_error(r.own, r.scales);
    return !r.added_by && r.point.modes >= 6;
  };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  EXPECT_EQ(found.reference->point.formulation, "exact");
  EXPECT_GT(lower_modes, 3) << "nothing was looked at";
}

TEST(FindReference, RunsThatAreThereAreNotMadeAgain) {
  const Prepared scene = soft_pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-6, {}, {}};
  goal.levels = 3;
  goal.finer = 1;
  goal.enough = [](const Reference& r) { return r.point.modes >= 4; };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  EXPECT_GT(found.cpu_seconds, 0);
  goal.made = found.runs;
  const ReferenceFound again = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(again.reference);
  EXPECT_EQ(again.cpu_seconds, 0);
  EXPECT_EQ(again.reference->own, found.reference->own);
}

/// Explicit steps cost a few milliseconds with two modes of the slew, and implicit ones several times that.
TEST(FindReference, AnIntegrationThatCostsLittleInAnyCaseIsMeasured) {
  const Prepared slew =
      prepare(SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/least-time-slew.yaml"), plugins());
  const Outputs outputs = Outputs::all(slew.model());
  Evaluator evaluator(slew, plugins(), outputs, {});
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-5, {}, {}};
  goal.levels = 1;
  goal.finer = 1;
  goal.integration = [](const Reference& r) { return relative_error(r.own, r.scales) / 2e-5; };
  goal.left = [] { return 1e4; };
  const ReferenceFound found = find_reference([&](const Point& p) -> const ModelAt& { return evaluator.model(p); },
                                              plugins(), outputs, goal, {});
  for (const char* integrator : {"dop853", "imex", "radau"})
    EXPECT_TRUE(std::any_of(found.runs.begin(), found.runs.end(), [&](const Reference& r) {
      return r.point.integrator == integrator && r.point.modes == 3;
    })) << integrator;
}

TEST(FindReference, ALowerRungIsNotBegunWithWhereThereIsNoTimeForAModeMoreInIt) {
  const Prepared scene = soft_pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto lower_runs = [&](double left) {
    ReferenceGoal goal;
    goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-6, {}, {}};
    goal.levels = 2;
    goal.finer = 1;
    goal.enough = [](const Reference& r) { return r.point.modes >= 5; };
    goal.steady = [](const Reference&) { return true; };
    goal.left = [=] { return left; };
    const ReferenceFound found = find_reference([&](const Point& p) -> const ModelAt& { return evaluator.model(p); },
                                                plugins(), outputs, goal, {});
    return std::count_if(found.runs.begin(), found.runs.end(),
                         [](const Reference& r) { return r.point.formulation == "quadratic"; });
  };
  EXPECT_EQ(lower_runs(0), 0);
  EXPECT_GT(lower_runs(1e3), 0);
}

/// Were the highest formulation free, it would be run with as many modes as the other: what is put together is as far
/// from that as it says.
TEST(FindReference, WhatAHigherRungAddsAtFewModesStandsForWhatItAddsAtMany) {
  const Prepared scene = soft_pendulum();
  const Outputs outputs(scene.model());
  Evaluator evaluator(scene, plugins(), outputs, {});
  const auto at = [&](const Point& p) -> const ModelAt& { return evaluator.model(p); };
  ReferenceGoal goal;
  goal.first = {"", "orthogonal-polynomials", 2, "dop853", 1e-8, {}, {}};
  goal.levels = 1;  // of the highest rung: no more is looked at there
  goal.enough = [](const Reference& r) { return r.added_by && r.point.modes >= 5; };
  goal.steady = [](const Reference&) { return true; };
  const ReferenceFound found = find_reference(at, plugins(), outputs, goal, {});
  ASSERT_TRUE(found.reference);
  const Reference& r = *found.reference;
  EXPECT_EQ(r.point.formulation, "quadratic");
  EXPECT_EQ(r.added_by->formulation, "exact");
  EXPECT_EQ(r.added_by->modes, 3);
  EXPECT_EQ(r.text(), r.point.text() + ", extrapolated, with what exact adds at 3 modes");

  const auto run = [&](const char* formulation, int modes) {
    Readings readings;
    const ModelAt& model = evaluator.model({formulation, "orthogonal-polynomials", modes, "", 0, {}, {}});
    OutputReader reader(outputs, model.prepared->model(), *model.prepared->equations);
    const Walk w = walk(*model.prepared, *make_integrator(plugins(), "dop853", 1e-10),
                        {[&](const State& s) {
                           readings.times.push_back(s.time);
                           readings.values.push_back(reader.read(s));
                           return true;
                         },
                         {},
                         {}});
    EXPECT_EQ(w.end, Walk::End::reached);
    return readings;
  };
  const Readings exact = run("exact", r.point.modes), quadratic = run("quadratic", r.point.modes);
  const Distances off = distances(outputs, r.readings, exact).first,
                  uncorrected = distances(outputs, quadratic, exact).first;
  for (std::size_t i = 0; i < off.size(); ++i) {
    EXPECT_LE(off[i], r.own[i] + 1e-9) << outputs.list()[i].label << ": it is known to what it says";
    EXPECT_LT(off[i], 0.2 * uncorrected[i] + 1e-9) << outputs.list()[i].label << ": the lower rung alone is not";
  }
}

}  // namespace
}  // namespace withy::study
