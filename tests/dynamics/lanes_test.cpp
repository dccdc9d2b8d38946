/// \file
/// Cases evaluated together, in the lanes of a vector register, against each case by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "random_case.hpp"
#include "withy/core/equations/lane_equations.hpp"
#include "withy/tests/conformance/allocations.hpp"

namespace withy::test {
namespace {

/// A chain of rigid links and beams on revolute and prismatic hinges under loads and, where asked, driven at its root.
/// Text of one seed and another differs in numbers only.
std::string lane_chain(unsigned seed, bool planar, const std::string& beam, bool driven) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return std::to_string(std::uniform_real_distribution<double>(low, high)(random));
  };
  const auto axis = [&] {
    return planar ? "[0, 0, 1]" : "[" + number(0.2, 1) + ", " + number(-1, 1) + ", " + number(-1, 1) + "]";
  };
  std::string bodies, hinges;
  for (int b = 0; b < 6; ++b) {
    const std::string name = "b" + std::to_string(b);
    if (b % 2 == 1 && !beam.empty()) {
      bodies += "  " + name + ": {type: beam, length: " + number(0.5, 2) + ", mass_per_length: " + number(0.5, 2) +
                ", damping_ratio: 0.01, bending_y: {stiffness: " + number(20, 90) + ", " + beam + "}" +
                (planar ? "" : ", bending_z: {stiffness: " + number(20, 90) + ", " + beam + "}") +
                ", frames: {a: {at: tip}}}\n";
    } else {
      bodies += "  " + name + ": {type: rigid, mass: " + number(0.5, 3) + ", center_of_mass: [" + number(-0.2, 0.2) +
                ", " + number(-0.2, 0.2) + ", 0], inertia: [0.2, 0.25, " + number(0.2, 0.3) +
                ", 0, 0, 0], frames: {a: {position: [" + number(0.1, 0.3) + ", " + number(0.1, 0.3) + ", 0]}}}\n";
    }
    const std::string parent = b == 0 ? "world" : "b" + std::to_string(b - 1) + ".a";
    hinges += "  h" + std::to_string(b) +
              ": {type: " + (b == 4 ? "prismatic, axis: [0.6, 0.8, 0]" : "revolute, axis: " + axis()) +
              ", parent: " + parent + ", child: " + name + "}\n";
  }
  return "format: withy/1\ntime: {end: 1.0}\ngravity: [" + number(-9, 9) + ", -9.81, 0]\nbodies:\n" + bodies +
         "hinges:\n" + hinges +
         "loads:\n  motor: {type: hinge-effort, hinge: h2, law: sine, amplitude: " + number(1, 9) +
         ", period: 0.7}\n  spring: {type: hinge-spring, hinge: h3, stiffness: " + number(1, 9) + "}\n" +
         (driven ? "motions:\n  turn: {type: spin-up, hinge: h0, rate: " + number(1, 2) + ", duration: 0.6}\n" : "");
}

/// Which case is in each lane; −1: nobody.
using Places = std::vector<int>;
/// Case i in lane i + shift, cyclically.
Places in_order(std::size_t shift = 0) {
  Places places(lane_count());
  for (std::size_t i = 0; i < places.size(); ++i) places[(i + shift) % places.size()] = static_cast<int>(i);
  return places;
}
Places only(std::size_t k, std::size_t lane) {
  Places places(lane_count(), -1);
  places[lane % places.size()] = static_cast<int>(k);
  return places;
}

/// A case for each lane with a state of its own, and what their evaluation gives.
struct LaneCases {
  std::vector<std::unique_ptr<Case>> cases;
  std::unique_ptr<LaneEquations> lanes;
  std::vector<std::vector<double>> rates{lane_count()};
  std::vector<Work> work;
  std::vector<LaneCall> calls{lane_count()};

  LaneCases(const std::string& formulation, const std::function<std::string(unsigned)>& text) {
    for (unsigned k = 0; k < lane_count(); ++k) {
      cases.push_back(std::make_unique<Case>(text(k), formulation));
      Case& c = *cases.back();
      RandomScene random(100 + k, {});
      c.state = random.state(*c.scene.model, c.scene.initial);
      rates[k].resize(c.equations->size());
      work.push_back(c.equations->make_work());
      work.back().poison();
    }
    lanes = lane_equations(*cases[0]->equations);
  }
  [[nodiscard]] const EquationsOfMotion& equations(std::size_t k) const { return *cases[k]->equations; }

  void evaluate(const Places& of) {
    std::vector<LaneCall*> asked(of.size());
    for (std::size_t lane = 0; lane < of.size(); ++lane) {
      if (of[lane] < 0) continue;
      const auto k = static_cast<std::size_t>(of[lane]);
      lanes->put(lane, equations(k));
      rates[k].assign(rates[k].size(), std::numeric_limits<double>::quiet_NaN());
      calls[lane] = {0.3, cases[k]->state.y, rates[k], &work[k], {}};
      asked[lane] = &calls[lane];
    }
    lanes->derivatives(asked);
  }
};

void expect_bits(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i])) << what << ", element " << i;
}

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

struct LaneKind {
  std::string formulation, beam;
  bool planar = false, driven = false;
  [[nodiscard]] std::string text() const {
    return formulation + (planar ? ", in a plane, " : ", in space, ") + (beam.empty() ? "rigid" : beam) +
           (driven ? ", driven" : "");
  }
};

std::vector<LaneKind> lane_kinds() {
  std::vector<LaneKind> all;
  for (const std::string formulation : {"ruthless", "quadratic"}) {
    for (const std::string beam : {"", "modes: 1", "modes: 2", "modes: 3", "modes: 2, family: free-free", "modes: 5"}) {
      for (const bool planar : {true, false}) {
        if (beam.ends_with('5') && !planar) continue;
        all.push_back({formulation, beam, planar, beam.ends_with("2")});
      }
    }
  }
  return all;
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
struct LaneSteps : LaneCases {
  static constexpr double t = 0.3, latest = 0.3008;
  std::vector<std::vector<double>> slope{lane_count()}, end{lane_count()};
  std::vector<std::array<std::vector<double>, 3>> slopes{lane_count()};
  std::vector<std::array<std::span<double>, 3>> places{lane_count()};
  std::vector<LaneStep> steps{lane_count()};

  explicit LaneSteps(const LaneKind& kind)
      : LaneCases(kind.formulation, [&](unsigned k) { return lane_chain_of_kind(k, kind); }) {
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
      steps[lane] = {{&three_stages(), t, length(k), latest, cases[k]->state.y, slope[k], places[k], end[k], &work[k]},
                     {}};
      asked[lane] = &steps[lane];
    }
    return asked;
  }
  void make(const Places& of) { lanes->steps(ask(of)); }
  /// All that a case gets, with what its loads did in the last stage.
  [[nodiscard]] std::vector<double> given(std::size_t k) {
    std::vector<double> all = end[k], loads(equations(k).layout().speeds), motions(loads.size());
    for (const std::vector<double>& s : slopes[k]) all.insert(all.end(), s.begin(), s.end());
    EXPECT_TRUE(equations(k).found_efforts(work[k], loads, motions));
    all.insert(all.end(), loads.begin(), loads.end());
    all.insert(all.end(), motions.begin(), motions.end());
    return all;
  }
};

/// Of the case's own equations, stage by stage; slopes relative to their greatest.
void expect_step(LaneSteps& several, std::size_t k, const std::string& what) {
  const StageTable& table = three_stages();
  const EquationsOfMotion& own = several.equations(k);
  Work work = own.make_work();
  const std::vector<double>& start = several.cases[k]->state.y;
  std::vector<std::vector<double>> slopes{several.slope[k]};
  std::vector<double> at;
  for (std::size_t i = 1; i < table.stages; ++i) {
    at = start;
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t e = 0; e < at.size(); ++e) at[e] += LaneSteps::length(k) * table.a.at(i).at(j) * slopes[j][e];
    slopes.emplace_back(at.size());
    const double time = std::min(LaneSteps::t + table.c.at(i) * LaneSteps::length(k), LaneSteps::latest);
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

TEST(Lanes, a_whole_step_is_that_of_its_stages_one_by_one) {
  for (const LaneKind& kind : lane_kinds()) {
    LaneSteps several(kind);
    several.make(in_order());
    for (std::size_t k = 0; k < lane_count(); ++k) {
      EXPECT_TRUE(several.steps[k].outcome.evaluation.ok()) << kind.text();
      EXPECT_EQ(several.steps[k].outcome.evaluations, 3U) << kind.text();
      expect_step(several, k, kind.text() + ", case " + std::to_string(k));
    }
  }
}

TEST(Lanes, a_whole_step_depends_on_no_other_case_to_the_last_bit) {
  for (const LaneKind& kind : lane_kinds()) {
    LaneSteps several(kind);
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

TEST(Lanes, evaluations_and_steps_allocate_nothing) {
  LaneCases several("quadratic", [](unsigned k) { return lane_chain(k, true, "modes: 2", true); });
  several.evaluate(in_order());
  std::vector<LaneCall*> asked(lane_count());
  for (std::size_t k = 0; k < lane_count(); ++k) asked[k] = &several.calls[k];
  const std::size_t before = allocations();
  several.lanes->derivatives(asked);
  EXPECT_EQ(allocations(), before);
  LaneSteps steps({"quadratic", "modes: 2", true, true});
  const std::vector<LaneStep*> wanted = steps.ask(in_order());
  const std::size_t before_steps = allocations();
  steps.lanes->steps(wanted);
  EXPECT_EQ(allocations(), before_steps);
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
}

}  // namespace
}  // namespace withy::test
