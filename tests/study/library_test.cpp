// The library as a host uses it: a scene is a value, studies give values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "withy/core/simulation/step_watch.hpp"
#include "withy/study/advice.hpp"
#include "withy/study/against_next.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/measures.hpp"
#include "withy/study/mounted_damping.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/run.hpp"
#include "withy/study/threshold.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using testing::HasSubstr;

using test::plugins;

double ratio_of(const Prepared& prepared, const MountedDamping& damping, const Holding& holding, std::size_t mode) {
  SceneValues values = prepared.values;
  for (const Change& change : damping.changes) values.set_text(change.text());
  const StartState start = [](const Prepared& p) { return p.scene.initial; };
  return sweep_modes(values, plugins(), start, holding, {}, true, {}, {}).points.front().modes[mode].damping_ratio();
}

/// A beam with a mass on its tip, six times its own: its modes are others than those of the beam alone.
TEST(StudyModes, OfAMountedBeamGetTheDampingRatiosThatAreAsked) {
  const Prepared prepared = prepare(
      SceneValues::parse("format: withy/1\nbodies:\n"
                         "  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 10, modes: 4}}\n"
                         "  load: {type: rigid, mass: 3, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}\nhinges:\n"
                         "  foot: {type: weld, parent: world, child: boom}\n"
                         "  top: {type: weld, parent: boom.tip, child: load}\n",
                         "boom"),
      plugins());
  for (const std::vector<double>& asked : {std::vector<double>{0.01}, {0.01, 0.01}, {0.005, 0.02}}) {
    const MountedDamping damping = mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), asked);
    ASSERT_EQ(damping.modes.size(), asked.size());
    for (std::size_t j = 0; j < asked.size(); ++j) {
      EXPECT_NEAR(damping.modes[j].reached, asked[j], 0.03 * asked[j]) << asked.size() << ' ' << j;
      EXPECT_NEAR(ratio_of(prepared, damping, {}, j), damping.modes[j].reached, 1e-9);
    }
  }
  const std::vector<double> too_many(5, 0.01);
  EXPECT_THROW(mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), too_many), InputError);
}

/// What a brake lets come to rest on a hinge that nothing holds is no vibration, and has no ratio of its own.
TEST(StudyModes, OfABrakedHingeTheVibrationsGetTheDampingRatiosThatAreAsked) {
  const Prepared prepared =
      prepare(SceneValues::parse(
                  "format: withy/1\nbodies:\n"
                  "  hub: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}\n"
                  "  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 200, modes: 3}}\n"
                  "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
                  "  root: {type: weld, parent: hub, child: boom}\n"
                  "loads: {brake: {type: hinge-spring, hinge: axle, damping: 1}}\ntime: {end: 1}\n",
                  "braked"),
              plugins());
  const MountedDamping damping = mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), {0.01, 0.02});
  EXPECT_NEAR(damping.modes[0].reached, 0.01, 1e-4);
  EXPECT_NEAR(damping.modes[1].reached, 0.02, 2e-4);
}

/// A damper gives the lowest mode six times what is asked: the others get theirs all the same.
TEST(StudyModes, WhatOneModeHasTooMuchOfTheOthersGetAsAsked) {
  const Prepared prepared =
      prepare(SceneValues::parse("format: withy/1\nbodies:\n"
                                 "  b: {type: beam, length: 2, mass_per_length: 1, bending_y: {stiffness: 40, modes: "
                                 "4}, frames: {m: {at: 1.566}}}\n"
                                 "hinges: {w: {type: weld, parent: world, child: b}}\n"
                                 "loads: {d: {type: spring-damper, frame: b.m, anchor: [1.566, -0.5, 0], stiffness: 0, "
                                 "damping: 0.7}}\ntime: {end: 1}\n",
                                 "braked"),
              plugins());
  const MountedDamping damping = mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), {0.01, 0.01, 0.01});
  EXPECT_EQ(damping.beyond, std::vector<std::size_t>{0});
  EXPECT_GT(damping.modes[0].reached, 0.06);
  for (const std::size_t j : {1, 2}) EXPECT_NEAR(damping.modes[j].reached, 0.01, 1e-3) << j;
}

/// Both lowest modes of the arm strain its links alike, in phase and against each other: no damping of each link by
/// itself gives one of them four times the ratio of the other. What is reached is what is reported.
TEST(StudyModes, DampingThatIsOutOfReachIsReportedAsWhatIsReached) {
  const Prepared prepared = prepare(scene("two-link-slew"), plugins());
  const Holding holding{{"shoulder", "elbow"}, {}};
  const MountedDamping damping = mounted_damping({prepared, prepared.scene.initial, holding}, plugins(), {0.005, 0.02});
  EXPECT_GT(std::abs(damping.modes[0].reached - 0.005), 0.001);
  for (std::size_t j = 0; j < 2; ++j)
    EXPECT_NEAR(ratio_of(prepared, damping, holding, j), damping.modes[j].reached, 1e-9);
}

/// Of 24 functions the squared frequencies of a clamped beam spread over 1e9.
TEST(StudyModes, DampingIsFoundForTheLowestOfManyModes) {
  const Prepared prepared =
      prepare(SceneValues::parse("format: withy/1\nbodies:\n  beam: {type: beam, length: 1.3, mass_per_length: 2, "
                                 "bending_y: {stiffness: 50, modes: 24, family: orthogonal-polynomials}}\n"
                                 "hinges:\n  root: {type: weld, parent: world, child: beam}\ntime: {end: 1}\n",
                                 "beam.yaml"),
              plugins());
  const MountedDamping damping = mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), {0.01, 0.02});
  EXPECT_NEAR(damping.modes[0].frequency / (3.5160152685 / (1.3 * 1.3) * 5), 1, 1e-5);
  EXPECT_NEAR(damping.modes[0].reached, 0.01, 1e-4);
  EXPECT_NEAR(damping.modes[1].reached, 0.02, 2e-4);
}

/// A bob above its pin falls slowly beside vibrations of a beam with 16 modes, whose squares are 1e8 times as great.
TEST(StudyModes, WhatGrowsSlowlyHasNoDampingRatioHoweverFastOthersAre) {
  const Prepared prepared =
      prepare(SceneValues::parse(
                  "format: withy/1\ngravity: [0, -9.81, 0]\nbodies:\n"
                  "  beam: {type: beam, length: 1.3, mass_per_length: 2, bending_y: {stiffness: 50, modes: 16, family: "
                  "orthogonal-polynomials}}\n"
                  "  bob: {type: rigid, mass: 1, center_of_mass: [0, 0.1, 0], inertia: [1, 1, 1, 0, 0, 0]}\n"
                  "hinges:\n  root: {type: weld, parent: world, child: beam}\n"
                  "  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: bob}\ntime: {end: 1}\n",
                  "bob.yaml"),
              plugins());
  EXPECT_THROW(mounted_damping({prepared, prepared.scene.initial, {}}, plugins(), {0.01}), std::domain_error);
}

TEST(StudyModes, SayHowFarTheyAreFromTheNextModelUp) {
  const Prepared prepared = prepare(scene("two-link-slew"), plugins());
  const Holding holding{{"shoulder", "elbow"}, {}};
  const StartState start = [](const Prepared& p) { return p.scene.initial; };
  const ModesOf run = sweep_modes(prepared.values, plugins(), start, holding, {}, false, {}, {});
  const auto against = frequencies_against_next(run, prepared.values, plugins(), start, holding, false, 4, {});
  ASSERT_TRUE(against);
  EXPECT_EQ(against->formulation, "exact");
  EXPECT_EQ(against->problem, "");
  EXPECT_EQ(against->compared, 4U);
  EXPECT_LT(against->most, 1e-6) << "straight and at rest both are the same";
}

TEST(StudyPrepare, SaysWhichFormulationCannotTreatAModel) {
  SceneValues values = scene("solar-panel");
  try {
    static_cast<void>(prepare(values.choose_formulation("exact", "the test"), plugins()));
    FAIL() << "a plate has no exact kinematics";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("formulation exact"), std::string::npos) << e.what();
  }
}

TEST(Measures, OneDistanceServesNamesAndMeasures) {
  const Prepared prepared = prepare(scene("beam-on-base"), plugins());
  const Outputs outputs = Outputs::all(prepared.model());
  OutputReader reader(outputs, prepared.model(), *prepared.equations);
  State turned = prepared.scene.initial;
  const Slot& base = prepared.model().layout().hinges.front();
  ASSERT_EQ(base.positions, 7U) << "a free hinge";
  turned.y[base.position] = std::cos(0.1);
  turned.y[base.position + 1] = std::sin(0.1);
  turned.y[base.position + 4] += 0.05;
  Distances greatest = outputs.none();
  outputs.raise(reader.read(prepared.scene.initial), reader.read(turned), greatest);
  EXPECT_NEAR(outputs.per_measure(greatest)[static_cast<std::size_t>(Measure::angle)], 0.2, 1e-12);
  EXPECT_NEAR(outputs.per_measure(greatest)[static_cast<std::size_t>(Measure::slide)], 0.05, 1e-12);
  EXPECT_NEAR(named(outputs, greatest, 0).greatest_hinge(), 0.2, 1e-12) << "the greater of both";
  // q and −q are one orientation.
  State mirrored = turned;
  for (std::size_t i = 0; i < 4; ++i) mirrored.y[base.position + i] *= -1;
  Distances none = outputs.none();
  outputs.raise(reader.read(turned), reader.read(mirrored), none);
  for (const double d : none) EXPECT_NEAR(d, 0, 1e-7);
}

TEST(Measures, WhatIsNoNumberIsInfinitelyFar) {
  const Prepared prepared = prepare(scene("pendulum"), plugins());
  const Outputs outputs(prepared.model());
  OutputReader reader(outputs, prepared.model(), *prepared.equations);
  State lost = prepared.scene.initial;
  lost.y[0] = std::nan("");
  Distances greatest = outputs.none();
  outputs.raise(reader.read(prepared.scene.initial), reader.read(lost), greatest);
  EXPECT_TRUE(std::isinf(greatest[0]));
}

/// Keeps what it is given.
struct MemoryStore : PointStore {
  std::map<std::string, Kept> kept;
  std::optional<Kept> find(const Point& point) override {
    const auto found = kept.find(point.key());
    return found == kept.end() ? std::nullopt : std::optional(found->second);
  }
  void keep(const Kept& k) override { kept.emplace(k.result.point.key(), k); }
};

TEST(StudyTrade, RunsInThreadsGiveWhatOneGivesAndAreRunOnce) {
  const Prepared prepared = prepare(short_slew(), plugins());
  const auto points = points_of({{"linear", "quadratic"}, {""}, {1, 2}, {"dopri5"}, {1e-4}, {}});
  MemoryStore store;
  TradeStudy several(prepared, plugins(), points, {3, &store, {}});
  ASSERT_TRUE(several.run());
  TradeStudy one(prepared, plugins(), points, {1, nullptr, {}});
  ASSERT_TRUE(one.run());
  const auto a = several.results(), b = one.results();
  ASSERT_EQ(a.size(), 4U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].status, "completed") << a[i].message;
    EXPECT_EQ(a[i].relative_error, b[i].relative_error);
    EXPECT_EQ(a[i].steps, b[i].steps);
  }
  ASSERT_EQ(store.kept.size(), 4U);
  TradeStudy again(prepared, plugins(), points, {1, &store, {[] { return true; }, {}}});
  EXPECT_EQ(again.results().size(), 4U) << "all are found";
}

/// Links that carry others: eigenfunctions of the bare beam converge so slowly that one more changes less than all
/// others together would.
TEST(StudyTrade, WhatAReferenceSaysOfItsOwnErrorHoldsAgainstAFinerOne) {
  const Prepared prepared = prepare(short_slew(), plugins());
  const Point point{"exact", "", 4, "dop853", 1e-6, {}, {}};
  const auto measured = [&](int most_modes) {
    Point finest = point;
    finest.modes = most_modes;
    TradeStudy study(prepared, plugins(), {point, finest}, {1, nullptr, {}});
    EXPECT_TRUE(study.run());
    return std::pair(study.result(point)->relative_error, study.references().begin()->second);
  };
  const auto [error, reference] = measured(5);
  const auto [finer_error, finer] = measured(8);
  EXPECT_EQ(reference.point.family, "craig-bampton");
  EXPECT_EQ(finer.point.modes, 9);
  EXPECT_LE(std::abs(error - finer_error), reference.relative_error);
  EXPECT_LT(reference.relative_error, 0.1 * error) << "it tells models apart";
}

TEST(StudyTrade, AnInterruptedStudyKeepsWhatIsFinished) {
  const Prepared prepared = prepare(short_slew(), plugins());
  int done = 0;
  const Control control{[&] { return done >= 1; }, [&](double, double) { ++done; }};
  TradeStudy study(prepared, plugins(), points_of({{"quadratic"}, {""}, {1, 2, 3}, {"dopri5"}, {1e-4}, {}}),
                   {1, nullptr, control});
  EXPECT_FALSE(study.run());
  EXPECT_EQ(study.results().size(), 1U);
}

TEST(StudyLinearModel, OfThePendulumIsItsFrequency) {
  const Prepared prepared = prepare(scene("pendulum"), plugins());
  State hanging = prepared.scene.initial;
  std::fill(hanging.y.begin(), hanging.y.end(), 0.0);
  const LinearModel linear = linear_model({prepared, hanging, {}}, {});
  ASSERT_EQ(linear.system.A.rows(), 2);
  // 1.2 kg, centre of mass 0.5 m from the pivot, 0.4 kg m² about it.
  EXPECT_NEAR(linear.system.A(1, 0), -1.2 * 9.81 * 0.5 / 0.4, 1e-9);
  EXPECT_TRUE(linear.equilibrium);
}

TEST(StudyModes, FollowASweepOfTheRateAndEndWhereAsked) {
  const Sweep sweep{"spin.axle", {0, 1, 2}};
  const ModesOf run = sweep_modes(scene("rotating-blade"), plugins(), {}, {}, sweep, false, {}, {});
  ASSERT_EQ(run.points.size(), 3U);
  for (std::size_t k = 0; k + 1 < run.points.size(); ++k) {
    ASSERT_FALSE(run.points[k].modes.empty()) << run.points[k].problem;
    EXPECT_LT(run.points[k].modes[0].frequency(), run.points[k + 1].modes[0].frequency()) << "rotation stiffens";
  }
  int asked = 0;
  const Control soon{[&] { return asked++ >= 1; }, {}};
  EXPECT_EQ(sweep_modes(scene("rotating-blade"), plugins(), {}, {}, sweep, false, {}, soon).points.size(), 1U);
}

TEST(StudyConfiguration, NamesTheHingesThatThereAre) {
  const Prepared prepared = prepare(scene("rotating-blade"), plugins());
  try {
    const Configuration c(prepared, prepared.scene.initial, {{"wheel"}, {}});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("known: axle"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace withy::study
