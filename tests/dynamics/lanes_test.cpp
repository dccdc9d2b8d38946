/// \file
/// Cases evaluated together, in the lanes of a vector register, against each case by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lane_cases.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

/// The backward error of accelerations, and the other rates as the case's own equations have them.
void expect_lane_solves(const Case& c, const std::vector<double>& lane, const std::string& what) {
  Work work = c.equations->make_work();
  std::vector<double> own(lane.size());
  ASSERT_TRUE(c.equations->derivatives(0.3, c.state.y, own, work).ok());
  const Layout& layout = c.equations->layout();
  const DenseSystem s = c.equations->system(0.3, c.state.y);
  for (std::size_t i = 0; i < s.size; ++i) {
    double residual = 0, scale = std::abs(s.force[i]) + 1e-12;
    for (std::size_t j = 0; j < s.size; ++j) {
      const double m = s.mass[i * s.size + j];
      residual += m * (lane[layout.positions + j] - own[layout.positions + j]);
      scale += std::abs(m * own[layout.positions + j]);
    }
    EXPECT_LT(std::abs(residual), 1e-11 * scale) << what << ", row " << layout.speed_names[i];
  }
  for (std::size_t i = 0; i < layout.positions; ++i) EXPECT_EQ(lane[i], own[i]) << what;
  EXPECT_NEAR(lane.back(), own.back(), 1e-9 * (1 + std::abs(own.back()))) << what << ": power";
}

TEST(Lanes, each_lane_solves_the_equations_of_its_own_case) {
  for (const LaneKind& kind : lane_kinds()) {
    LaneCases several(kind.formulation, [&](unsigned k) { return lane_chain(k, kind.planar, kind.beam, kind.driven); });
    ASSERT_NE(several.lanes, nullptr) << kind.text() << ": " << lane_refusal(several.equations(0));
    for (std::size_t k = 0; k < lane_count(); ++k)
      EXPECT_TRUE(several.lanes->fits(several.equations(k))) << kind.text();
    several.evaluate(in_order());
    for (std::size_t k = 0; k < lane_count(); ++k) {
      EXPECT_TRUE(several.calls[k].evaluation.ok()) << kind.text();
      expect_lane_solves(*several.cases[k], several.rates[k], kind.text() + ", case " + std::to_string(k));
    }
  }
}

/// Trees with branches, beams held at their tip and every mode family.
TEST(Lanes, each_lane_solves_the_equations_of_random_trees_in_a_plane) {
  int evaluated = 0;
  for (const std::string formulation : {"ruthless", "quadratic"}) {
    for (unsigned seed = 1; seed <= 25; ++seed) {
      const SceneWish wish{
          .bodies = 2 + static_cast<int>(seed % 6), .planar = true, .any_root = seed % 2 == 0, .any_family = true};
      LaneCases several(formulation, [&](unsigned) { return RandomScene(seed, wish).text(); });
      if (several.equations(0).layout().speeds == 0) continue;
      ASSERT_NE(several.lanes, nullptr) << lane_refusal(several.equations(0));
      several.evaluate(in_order());
      ++evaluated;
      for (std::size_t k = 0; k < lane_count(); ++k)
        expect_lane_solves(*several.cases[k], several.rates[k], formulation + ", seed " + std::to_string(seed));
    }
  }
  EXPECT_GT(evaluated, 30);
}

TEST(Lanes, what_a_case_gets_depends_on_no_other_to_the_last_bit) {
  for (const LaneKind& kind : lane_kinds()) {
    LaneCases several(kind.formulation, [&](unsigned k) { return lane_chain(k, kind.planar, kind.beam, kind.driven); });
    several.evaluate(in_order());
    const std::vector<std::vector<double>> among = several.rates;
    const auto expect_unchanged = [&](std::size_t k, const char* how) {
      expect_bits(several.rates[k], among[k], kind.text() + ", case " + std::to_string(k) + how);
    };
    for (const std::size_t shift : {std::size_t{1}, lane_count() / 2 + 1}) {
      several.evaluate(in_order(shift));
      for (std::size_t k = 0; k < lane_count(); ++k) expect_unchanged(k, " in another lane");
    }
    for (std::size_t k = 0; k < lane_count(); ++k) {
      // A group that another case has begun, and what it has left in the other lanes.
      several.lanes = lane_equations(several.equations(3));
      several.evaluate(only(k, k + 2));
      expect_unchanged(k, " alone");
    }
    // Beside cases that have no accelerations, or are far away.
    std::vector<double>& lost = several.cases[1]->state.y;
    std::vector<double>& far = several.cases[2]->state.y;
    std::fill(lost.begin(), lost.end(), std::numeric_limits<double>::quiet_NaN());
    far[0] = 3e7;
    Places places = in_order();
    std::rotate(places.begin(), places.begin() + 1, places.begin() + 3);
    several.evaluate(places);
    expect_unchanged(0, " beside one without end");
    expect_unchanged(3, " beside one without end");
    std::vector<double> own(lost.size());
    const Evaluation alone = several.equations(1).derivatives(0.3, lost, own, several.work[1]);
    EXPECT_FALSE(alone.ok()) << kind.text();
    EXPECT_EQ(several.calls[0].evaluation.outcome, alone.outcome) << kind.text();
    EXPECT_EQ(several.calls[0].evaluation.body, alone.body) << kind.text();
    expect_lane_solves(*several.cases[2], several.rates[2], kind.text() + ", far away");
  }
}

TEST(Lanes, evaluations_allocate_nothing) {
  LaneCases several("quadratic", [](unsigned k) { return lane_chain(k, true, "modes: 2", true); });
  several.evaluate(in_order());
  std::vector<LaneCall*> asked(lane_count());
  for (std::size_t k = 0; k < lane_count(); ++k) asked[k] = &several.calls[k];
  const std::size_t before = allocations();
  several.lanes->derivatives(asked);
  EXPECT_EQ(allocations(), before);
}

TEST(Lanes, a_case_with_another_structure_does_not_fit) {
  const Case two(lane_chain(1, true, "modes: 2", false), "quadratic"),
      three(lane_chain(1, true, "modes: 3", false), "quadratic");
  const Case space(lane_chain(1, false, "modes: 2", false), "quadratic"),
      ruthless(lane_chain(1, true, "modes: 2", false), "ruthless");
  const auto lanes = lane_equations(*two.equations);
  ASSERT_NE(lanes, nullptr);
  EXPECT_FALSE(lanes->fits(*three.equations));
  EXPECT_FALSE(lanes->fits(*space.equations));
  EXPECT_FALSE(lanes->fits(*ruthless.equations));
}

TEST(Lanes, equations_without_lanes_say_why) {
  const Case consistent(lane_chain(1, true, "modes: 2", false), "consistent"),
      exact(lane_chain(1, true, "modes: 2", false), "exact");
  EXPECT_EQ(lane_equations(*consistent.equations), nullptr);
  EXPECT_EQ(lane_refusal(*consistent.equations), "the formulation is none of the symmetric ones");
  EXPECT_EQ(lane_refusal(*exact.equations), "a beam moves by exact kinematics");
  const std::string tree = lane_chain(1, true, "modes: 2", false);
  const Case locked(tree + "events:\n  latch: {at: 0.5, do: {lock: h2}}\n", "quadratic"),
      stopped(tree + "events:\n  halt: {at: 0.5, stop: true}\n", "quadratic");
  EXPECT_EQ(lane_refusal(*locked.equations), "events lock or let go of hinges, and the equations are others then");
  EXPECT_EQ(lane_refusal(*stopped.equations), "") << "the equations stay the same";
}

}  // namespace
}  // namespace withy::test
