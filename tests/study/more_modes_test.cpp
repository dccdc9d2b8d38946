// What a certificate says of modes that a run does not have.
#include "withy/study/more_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "withy/study/point.hpp"
#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

CertifiedRun certified(const SceneValues& values, Estimate estimate = Estimate::always) {
  RunSettings settings;
  settings.estimate = estimate;
  return run(prepare(values, plugins()), plugins(), settings);
}

SceneValues slew_with(int modes) {
  SceneValues values = short_slew();
  for (const char* link : {"link1", "link2"})
    values.set(std::string("bodies.") + link + ".bending_y.modes", Value(static_cast<double>(modes)), "the test");
  return values;
}

/// Positions of the payload at the outputs of a run by itself [m].
std::vector<Vector3> payload_path(const SceneValues& values) {
  const Prepared prepared = prepare(values, plugins());
  const int payload = prepared.model().body("payload");
  const int tip = prepared.model().bodies()[static_cast<std::size_t>(payload)].frame("tip");
  std::vector<Vector3> path;
  simulate(prepared, plugins(), [&](const State& state) {
    const auto p = prepared.equations->frame_pose(state.y, payload, tip).position;
    path.emplace_back(p[0], p[1], p[2]);
  });
  return path;
}

TEST(MoreModesOfARun, ChangeItByWhatTwoRunsByThemselvesDiffer) {
  const CertifiedRun run = certified(slew_with(1));
  const MoreModesOutcome& outcome = run.certificate.more_modes;
  ASSERT_TRUE(outcome.more) << outcome.why_not;
  // They are compared at 500 times, whatever a scene writes to its results.
  const auto path = [](int modes) {
    SceneValues values = slew_with(modes);
    return payload_path(values.set("time.output", Value(0.2 / 500), "the test"));
  };
  const std::vector<Vector3> one = path(1), two = path(2);
  ASSERT_EQ(one.size(), two.size());
  double apart = 0;
  for (std::size_t i = 0; i < one.size(); ++i) apart = std::max(apart, (one[i] - two[i]).norm());
  EXPECT_GT(apart, 1e-5) << "a mode more is to matter here";
  // The same steps of the same equations; the sum of squares may be rounded otherwise.
  EXPECT_NEAR(outcome.more->distances.tips.at("payload.tip"), apart, 1e-9 * apart);
  EXPECT_EQ(outcome.more->distances.until, run.summary.reached);
}

TEST(MoreModesOfARun, ChangeItLessWhereThereAreManyAlready) {
  const CertifiedRun few = certified(slew_with(1)), more = certified(slew_with(4));
  ASSERT_TRUE(few.certificate.more_modes.more && more.certificate.more_modes.more);
  EXPECT_LT(more.certificate.more_modes.more->distances.greatest_tip(),
            0.2 * few.certificate.more_modes.more->distances.greatest_tip());
}

TEST(MoreModesOfARun, BeginAtRestBesideWhatTheInitialStateSaysOfTheOthers) {
  const SceneValues values = scene("spacecraft");
  const Prepared few = prepare(values, plugins());
  const Prepared more = prepare(with_more_modes(values, few.scene, 1, plugins()), plugins());
  // Bending, bending and torsion of the left boom: 2, 2 and 1 modes, and then 3, 3 and 2.
  const auto of_boom = [](const Prepared& p) {
    const Slot& slot = *p.model().layout().body("left_boom");
    const double* const q = p.scene.initial.y.data() + slot.position;
    return std::vector<double>(q, q + slot.positions);
  };
  const std::vector<double> had = of_boom(few);
  ASSERT_EQ(had.size(), 5U);
  EXPECT_EQ(of_boom(more), (std::vector<double>{had[0], had[1], 0, had[2], had[3], 0, had[4], 0}));
}

/// A limit between the deflections of both: what passes it is no motion to compare with.
TEST(MoreModesOfARun, HaveTheLimitsOfAnyRun) {
  const auto deflection = [](int modes) {
    return certified(slew_with(modes), Estimate::never).summary.peak_deflection_ratio.at("link2");
  };
  const double few = deflection(1), more = deflection(2);
  ASSERT_GT(more, 1.001 * few) << "a mode more is to bend further";
  SceneValues values = slew_with(1);
  const CertifiedRun run = certified(values.set("limits.deflection", Value(0.5 * (few + more)), "the test"));
  EXPECT_EQ(run.summary.status, RunStatus::completed) << run.summary.message;
  EXPECT_FALSE(run.certificate.more_modes.more);
  EXPECT_THAT(run.certificate.more_modes.why_not,
              HasSubstr("the run with one mode more of each ended as diverged: t = "));
}

TEST(MoreModesOfARun, AreNotLookedAtUnlessAskedFor) {
  const MoreModesOutcome outcome = certified(short_slew(), Estimate::automatic).certificate.more_modes;
  EXPECT_FALSE(outcome.more);
  EXPECT_THAT(outcome.why_not, HasSubstr("--estimate always"));
}

TEST(MoreModesOfARun, ThatABodyCannotHaveAreSaidToBeNone) {
  SceneValues values = scene("gallery/spinning-plate");
  values.set("time.end", Value(0.1), "the test").set("bodies.plate.modes", Value(12.0), "the test");
  const MoreModesOutcome outcome = certified(values).certificate.more_modes;
  EXPECT_FALSE(outcome.more);
  EXPECT_THAT(outcome.why_not, HasSubstr("/bodies/plate/modes: got 13"));
}

TEST(MoreModesOfARun, AreNoneOfABodyWithoutANumberOfThem) {
  SceneValues values = scene("imported-boom");
  values.set("time.end", Value(0.1), "the test");
  const MoreModesOutcome outcome = certified(values).certificate.more_modes;
  EXPECT_FALSE(outcome.more);
  EXPECT_EQ(outcome.why_not, "");
}

TEST(MoreModesOfARun, AreNotComparedWhereLoadsSwitch) {
  SceneValues values = scene("attitude-jets");
  values.set("time.end", Value(0.5), "the test");
  const MoreModesOutcome outcome = certified(values).certificate.more_modes;
  EXPECT_FALSE(outcome.more);
  EXPECT_THAT(outcome.why_not, HasSubstr("load 'jets' switches at zeros of a function of the state"));
}

}  // namespace
}  // namespace withy::study
