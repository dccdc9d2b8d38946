/// \file
/// Whole steps and energies of cases in the lanes of a vector register, against each case by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "lane_cases.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

/// A method of three stages behind the first that leaves one out.
const StageTable& three_stages() {
  static const StageTable table = [] {
    StageTable t;
    t.stages = 4;
    t.c = {0, 0.5, 0.75, 1};
    t.a[1] = {0.5};
    t.a[2] = {0, 0.75};
    t.a[3] = {2.0 / 9, 1.0 / 3, 4.0 / 9};
    return t;
  }();
  return table;
}

/// The chain; every second one has loads that are functions of time alone.
std::string lane_chain_of_kind(unsigned k, const LaneKind& kind) {
  std::string text = lane_chain(k, kind.planar, kind.beam, kind.driven);
  const std::size_t spring = text.find("  spring:");
  return k % 2 == 0 ? text : text.erase(spring, text.find('\n', spring) + 1 - spring);
}

/// A step of each case, from its state at 0.3 s.
struct StepsOfCases : LaneCases {
  static constexpr double t = 0.3, latest = 0.3008;
  std::vector<std::vector<double>> slope{lane_count()}, end{lane_count()};
  std::vector<std::array<std::vector<double>, 3>> slopes{lane_count()};
  std::vector<std::array<std::span<double>, 3>> places{lane_count()};
  std::vector<StagedSteps::Step> given_steps{lane_count()};
  std::vector<LaneStep> steps{lane_count()};

  /// \param seed of each case
  explicit StepsOfCases(
      const LaneKind& kind, unsigned (*seed)(unsigned) = [](unsigned k) { return k; })
      : LaneCases(kind.formulation, [&](unsigned k) { return lane_chain_of_kind(seed(k), kind); }) {
    for (std::size_t k = 0; k < lane_count(); ++k) {
      slope[k].resize(rates[k].size());
      EXPECT_TRUE(equations(k).derivatives(t, cases[k]->state.y, slope[k], work[k]).ok());
    }
  }
  static double length(std::size_t k) { return 1e-3 * (1 + 0.1 * static_cast<double>(k % 3)); }

  std::vector<LaneStep*> ask(const Places& of) {
    std::vector<LaneStep*> asked(of.size());
    for (std::size_t lane = 0; lane < of.size(); ++lane) {
      if (of[lane] < 0) continue;
      const auto k = static_cast<std::size_t>(of[lane]);
      lanes->put(lane, equations(k));
      end[k].assign(slope[k].size(), std::numeric_limits<double>::quiet_NaN());
      for (std::size_t i = 0; i < 3; ++i) {
        slopes[k].at(i) = end[k];
        places[k].at(i) = slopes[k].at(i);
      }
      given_steps[lane] = {&three_stages(), t,         length(k), latest,  cases[k]->state.y,
                           slope[k],        places[k], end[k],    &work[k]};
      steps[lane] = {&given_steps[lane], {}};
      asked[lane] = &steps[lane];
    }
    return asked;
  }
  void make(const Places& of) { lanes->steps(ask(of)); }
  /// All that a case gets, with what its loads did in the last stage.
  [[nodiscard]] std::vector<double> given(std::size_t k) {
    std::vector<double> all = end[k], loads(equations(k).layout().speeds), motions(loads.size());
    for (const std::span<double> s : places[k]) all.insert(all.end(), s.begin(), s.end());
    EXPECT_TRUE(equations(k).found_efforts(work[k], loads, motions));
    all.insert(all.end(), loads.begin(), loads.end());
    all.insert(all.end(), motions.begin(), motions.end());
    return all;
  }
};

/// Of the case's own equations, stage by stage; slopes relative to their greatest.
void expect_step(StepsOfCases& several, std::size_t k, const std::string& what) {
  const StageTable& table = three_stages();
  const EquationsOfMotion& own = several.equations(k);
  Work work = own.make_work();
  const std::vector<double>& start = several.cases[k]->state.y;
  std::vector<std::vector<double>> slopes{several.slope[k]};
  std::vector<double> at;
  for (std::size_t i = 1; i < table.stages; ++i) {
    at = start;
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t e = 0; e < at.size(); ++e) at[e] += StepsOfCases::length(k) * table.a.at(i).at(j) * slopes[j][e];
    slopes.emplace_back(at.size());
    const double time = std::min(StepsOfCases::t + table.c.at(i) * StepsOfCases::length(k), StepsOfCases::latest);
    ASSERT_TRUE(own.derivatives(time, at, slopes.back(), work).ok()) << what;
  }
  const auto expect_near = [&](const std::vector<double>& lane, const std::vector<double>& one) {
    double greatest = 1;
    for (const double x : one) greatest = std::max(greatest, std::abs(x));
    // What rounding makes of accelerations grows with the condition of the mass matrix.
    for (std::size_t e = 0; e < one.size(); ++e) EXPECT_NEAR(lane[e], one[e], 1e-8 * greatest) << what << ", " << e;
  };
  expect_near(several.end[k], at);
  for (std::size_t i = 1; i < table.stages; ++i) expect_near(several.slopes[k].at(i - 1), slopes[i]);
  std::vector<double> lane = several.given(k), loads(own.layout().speeds), motions(loads.size());
  ASSERT_TRUE(own.found_efforts(work, loads, motions));
  loads.insert(loads.end(), motions.begin(), motions.end());
  lane.erase(lane.begin(), lane.end() - static_cast<std::ptrdiff_t>(loads.size()));
  expect_near(lane, loads);
}

TEST(LaneSteps, a_whole_step_is_that_of_its_stages_one_by_one) {
  for (const LaneKind& kind : lane_kinds()) {
    StepsOfCases several(kind);
    several.make(in_order());
    for (std::size_t k = 0; k < lane_count(); ++k) {
      EXPECT_TRUE(several.steps[k].outcome.evaluation.ok()) << kind.text();
      EXPECT_EQ(several.steps[k].outcome.evaluations, 3U) << kind.text();
      expect_step(several, k, kind.text() + ", case " + std::to_string(k));
    }
  }
}

TEST(LaneSteps, a_whole_step_depends_on_no_other_case_to_the_last_bit) {
  for (const LaneKind& kind : lane_kinds()) {
    StepsOfCases several(kind);
    several.make(in_order());
    std::vector<std::vector<double>> among;
    for (std::size_t k = 0; k < lane_count(); ++k) among.push_back(several.given(k));
    const auto expect_unchanged = [&](std::size_t k, const char* how) {
      expect_bits(several.given(k), among[k], kind.text() + ", case " + std::to_string(k) + how);
    };
    several.make(in_order(lane_count() / 2 + 1));
    for (std::size_t k = 0; k < lane_count(); ++k) expect_unchanged(k, " in another lane");
    for (std::size_t k = 0; k < lane_count(); ++k) {
      several.lanes = lane_equations(several.equations(3));
      several.make(only(k, k + 2));
      expect_unchanged(k, " alone");
    }
    std::vector<double>& lost = several.cases[1]->state.y;
    std::fill(lost.begin(), lost.end(), std::numeric_limits<double>::quiet_NaN());
    Places places = in_order();
    std::rotate(places.begin(), places.begin() + 1, places.begin() + 3);
    several.make(places);
    expect_unchanged(0, " beside one without end");
    expect_unchanged(3, " beside one without end");
    std::vector<double> own(lost.size());
    const Evaluation alone = several.equations(1).derivatives(0.3, lost, own, several.work[1]);
    EXPECT_EQ(several.steps[0].outcome.evaluation.outcome, alone.outcome) << kind.text();
    EXPECT_EQ(several.steps[0].outcome.evaluation.body, alone.body) << kind.text();
    EXPECT_EQ(several.steps[0].outcome.evaluations, 1U) << kind.text();
  }
}

/// Five steps of each case one after the other, from its state at 0.3 s, as a run asks for them: each case goes on
/// where its own last step ended, and tells the ends of those to come where `ahead`.
class StepsOneAfterTheOther : public StepsOfCases {
 public:
  static constexpr std::size_t count = 5;
  /// All loads are functions of time alone.
  explicit StepsOneAfterTheOther(const LaneKind& kind) : StepsOfCases(kind, [](unsigned k) { return 2 * k + 1; }) {
    for (std::size_t k = 0; k < lane_count(); ++k)
      for (std::size_t i = 0; i <= count; ++i)
        times[k].push_back(t + 0.01 * length(k) * static_cast<double>(i));  // stable
  }

  /// What each case is given, step by step, with the energies there. \param first steps before all cases begin anew
  std::vector<std::vector<double>> run(bool ahead, std::size_t first = count) {
    for (std::size_t k = 0; k < lane_count(); ++k) lanes->put(k, equations(k));
    std::vector<std::vector<double>> all(lane_count());
    std::vector<std::vector<double>> y, own_slope = slope;
    for (std::size_t k = 0; k < lane_count(); ++k) y.push_back(cases[k]->state.y);
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<LaneStep*> asked(lane_count());
      for (std::size_t k = 0; k < lane_count(); ++k) {
        const std::size_t n = y[k].size();
        end[k].resize(n), slopes[k][2].resize(n);
        places[k] = {std::span<double>(), std::span<double>(), slopes[k][2]};
        given_steps[k] = {.table = &three_stages(),
                          .t = times[k][i],
                          .h = times[k][i + 1] - times[k][i],
                          .latest = 1,
                          .y = y[k],
                          .slope = own_slope[k],
                          .slopes = places[k],
                          .end = end[k],
                          .work = &work[k],
                          .ends = ahead ? std::span<const double>(times[k]).subspan(i + 1) : std::span<const double>(),
                          .follows = i != 0 && i != first};
        steps[k] = {&given_steps[k], {}};
        if (lanes->made_ahead(k, steps[k]))
          ++made_ahead;
        else
          asked[k] = &steps[k];
      }
      if (std::any_of(asked.begin(), asked.end(), [](const LaneStep* s) { return s != nullptr; })) lanes->steps(asked);
      for (std::size_t k = 0; k < lane_count(); ++k) {
        y[k] = end[k], own_slope[k] = slopes[k][2];
        const std::vector<double> now = given(k);
        all[k].insert(all[k].end(), now.begin(), now.end());
        append_energies(k, y[k], all[k]);
      }
    }
    return all;
  }
  std::size_t made_ahead = 0, energies_ahead = 0;

 private:
  void append_energies(std::size_t k, const std::vector<double>& at, std::vector<double>& to) {
    LaneEnergy call{at, {}};
    std::vector<LaneEnergy*> asked(lane_count());
    asked[k] = &call;
    if (lanes->made_ahead(k, call))
      ++energies_ahead;
    else
      lanes->energies(asked);
    to.insert(to.end(), {call.energies.kinetic, call.energies.potential});
  }
  std::vector<std::vector<double>> times{lane_count()};
};

TEST(LaneSteps, made_before_they_are_asked_for_are_the_same_to_the_last_bit) {
  for (const LaneKind& kind : lane_kinds()) {
    if (kind.driven) continue;  // such steps are made one by one
    StepsOneAfterTheOther one_by_one(kind), at_once(kind), interrupted(kind);
    const std::vector<std::vector<double>> expected = one_by_one.run(false);
    EXPECT_EQ(one_by_one.made_ahead, 0U) << kind.text();
    const auto expect_those = [&](const std::vector<std::vector<double>>& found, const std::string& how) {
      for (std::size_t k = 0; k < lane_count(); ++k)
        expect_bits(found[k], expected[k], kind.text() + how + ", case " + std::to_string(k));
    };
    expect_those(at_once.run(true), ", at once");
    EXPECT_EQ(at_once.made_ahead, 4 * lane_count()) << kind.text();
    EXPECT_EQ(at_once.energies_ahead, 0U) << kind.text() << ": nobody knew that they would be asked for";
    expect_those(interrupted.run(true, 3), ", where a step that nobody expects comes between");
    EXPECT_EQ(interrupted.made_ahead, 3 * lane_count()) << kind.text();
    EXPECT_EQ(interrupted.energies_ahead, 2 * lane_count()) << kind.text();
  }
}

TEST(LaneSteps, allocate_nothing) {
  StepsOfCases steps({"quadratic", "modes: 2", true, true});
  const std::vector<LaneStep*> wanted = steps.ask(in_order());
  const std::size_t before = allocations();
  steps.lanes->steps(wanted);
  EXPECT_EQ(allocations(), before);
}

/// Energies of each case at its state.
struct EnergiesOfCases : LaneCases {
  std::vector<LaneEnergy> calls{lane_count()};
  using LaneCases::LaneCases;

  std::vector<LaneEnergy*> ask(const Places& of) {
    std::vector<LaneEnergy*> asked(of.size());
    for (std::size_t lane = 0; lane < of.size(); ++lane) {
      if (of[lane] < 0) continue;
      const auto k = static_cast<std::size_t>(of[lane]);
      lanes->put(lane, equations(k));
      calls[k] = {cases[k]->state.y, {}};
      asked[lane] = &calls[k];
    }
    return asked;
  }
  void find(const Places& of) { lanes->energies(ask(of)); }
  [[nodiscard]] std::vector<double> given(std::size_t k) const { return numbers(calls[k].energies); }
  static std::vector<double> numbers(const Energies& e) {
    return {e.kinetic,
            e.potential,
            e.linear_momentum[0],
            e.linear_momentum[1],
            e.linear_momentum[2],
            e.angular_momentum[0],
            e.angular_momentum[1],
            e.angular_momentum[2]};
  }
};

TEST(LaneEnergies, are_those_of_each_case_by_itself) {
  const auto expect_own = [](EnergiesOfCases& several, const std::string& what) {
    several.find(in_order());
    for (std::size_t k = 0; k < lane_count(); ++k) {
      const auto own = several.equations(k).make_observation();
      own->observe(several.cases[k]->state.y);
      const std::vector<double> one = EnergiesOfCases::numbers(own->energies()), lane = several.given(k);
      // Of sums of as many parts: their signs differ.
      double greatest = 1;
      for (const double x : one) greatest = std::max(greatest, std::abs(x));
      for (std::size_t i = 0; i < one.size(); ++i)
        EXPECT_NEAR(lane[i], one[i], 1e-13 * greatest) << what << ", case " << k << ", number " << i;
    }
  };
  for (const LaneKind& kind : lane_kinds()) {
    EnergiesOfCases several(kind.formulation,
                            [&](unsigned k) { return lane_chain(k, kind.planar, kind.beam, kind.driven); });
    ASSERT_NE(several.lanes, nullptr) << kind.text();
    ASSERT_TRUE(several.lanes->has_energies()) << kind.text();
    expect_own(several, kind.text());
  }
  int found = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const SceneWish wish{
        .bodies = 2 + static_cast<int>(seed % 6), .planar = true, .any_root = seed % 2 == 0, .any_family = true};
    EnergiesOfCases several("quadratic", [&](unsigned) { return RandomScene(seed, wish).text(); });
    if (several.lanes == nullptr || !several.lanes->has_energies()) continue;
    ++found;
    expect_own(several, "seed " + std::to_string(seed));
  }
  EXPECT_GT(found, 15);
}

TEST(LaneEnergies, depend_on_no_other_case_to_the_last_bit) {
  for (const LaneKind& kind : lane_kinds()) {
    EnergiesOfCases several(kind.formulation,
                            [&](unsigned k) { return lane_chain(k, kind.planar, kind.beam, kind.driven); });
    several.find(in_order());
    std::vector<std::vector<double>> among;
    for (std::size_t k = 0; k < lane_count(); ++k) among.push_back(several.given(k));
    const auto expect_unchanged = [&](std::size_t k, const char* how) {
      expect_bits(several.given(k), among[k], kind.text() + ", case " + std::to_string(k) + how);
    };
    several.find(in_order(lane_count() / 2 + 1));
    for (std::size_t k = 0; k < lane_count(); ++k) expect_unchanged(k, " in another lane");
    for (std::size_t k = 0; k < lane_count(); ++k) {
      several.lanes = lane_equations(several.equations(3));
      several.find(only(k, k + 2));
      expect_unchanged(k, " alone");
    }
    std::vector<double>& lost = several.cases[1]->state.y;
    std::fill(lost.begin(), lost.end(), std::numeric_limits<double>::quiet_NaN());
    several.find(in_order());
    expect_unchanged(0, " beside one without end");
    expect_unchanged(3, " beside one without end");
  }
}

TEST(LaneEnergies, allocate_nothing) {
  EnergiesOfCases several("quadratic", [](unsigned k) { return lane_chain(k, true, "modes: 2", true); });
  const std::vector<LaneEnergy*> wanted = several.ask(in_order());
  const std::size_t before = allocations();
  several.lanes->energies(wanted);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace withy::test
