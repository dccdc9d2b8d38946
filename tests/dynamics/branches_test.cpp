/// \file
/// Branches of one tree on threads, against one thread that sweeps all of it.
#include "withy/core/sweep/branches.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <numeric>
#include <thread>

#include "random_case.hpp"
#include "withy/core/equations/branch_equations.hpp"

namespace withy::test {
namespace {

/// Three chains on a hub that turns or floats, of as many links as are asked for, every third of them a beam.
std::string chains(const std::vector<int>& lengths, bool planar, bool floats) {
  const std::string hub =
      "{type: rigid, mass: 4, inertia: [1, 2, 3, 0, 0, 0], frames: {a: {position: [0.3, 0, 0]}, "
      "b: {position: [-0.3, 0.1, 0]}, c: {position: [0, -0.2, 0]}}}";
  std::string bodies = "  hub: " + hub + "\n";
  std::string hinges = std::string("  root: {type: ") + (floats ? "free" : "revolute, axis: [0, 0, 1]") +
                       ", parent: world, child: hub}\n";
  for (std::size_t c = 0; c < lengths.size(); ++c) {
    const std::string chain(1, static_cast<char>('a' + c));
    for (int i = 0; i < lengths[c]; ++i) {
      const std::string name = chain + std::to_string(i);
      const std::string body =
          i % 3 != 1
              ? "{type: rigid, mass: 0.5, center_of_mass: [0.2, 0.01, 0], inertia: [0.01, 0.02, 0.02, 0, 0, 0], "
                "frames: {tip: {position: [0.4, 0, 0]}}}"
              : std::string("{type: beam, length: 0.5, mass_per_length: 0.6, bending_y: {stiffness: 50, modes: 2}") +
                    (planar ? "}" : ", bending_z: {stiffness: 70, modes: 1}}");
      const char* const axis = planar || i % 2 == 0 ? "[0, 0, 1]" : "[0, 0.6, 0.8]";
      bodies += "  " + name + ": " + body + "\n";
      hinges += "  h" + name + ": {type: revolute, axis: " + axis +
                ", parent: " + (i == 0 ? "hub." + chain : chain + std::to_string(i - 1) + ".tip") + ", child: " + name +
                "}\n";
    }
  }
  return "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 0]\nbodies:\n" + bodies + "hinges:\n" + hinges +
         "loads:\n  motor: {type: hinge-effort, hinge: ha0, law: sine, amplitude: 3, period: 0.7}\n";
}

/// What evaluations give of one state, with memory that holds nothing of use.
struct Given {
  Evaluation evaluation;
  std::vector<std::uint64_t> bits;
};
Given derivatives(const EquationsOfMotion& equations, const State& state) {
  Work work = equations.make_work();
  work.poison();
  std::vector<double> rates(equations.size(), std::numeric_limits<double>::quiet_NaN());
  Given given{equations.derivatives(state.time, state.y, rates, work), {}};
  if (given.evaluation.ok())
    for (const double x : rates) given.bits.push_back(std::bit_cast<std::uint64_t>(x));
  return given;
}
void expect_same(const Given& a, const Given& b, const std::string& what) {
  EXPECT_EQ(a.evaluation.outcome, b.evaluation.outcome) << what;
  EXPECT_EQ(a.evaluation.body, b.evaluation.body) << what;
  EXPECT_EQ(a.bits, b.bits) << what;
}

/// A case whose equations may be shared with threads.
struct SharedCase : Case {
  SharedCase(const std::string& text, const std::string& formulation) : Case(text, formulation) { move(); }
  SharedCase(unsigned seed, const SceneWish& wish, const std::string& formulation) : Case(seed, wish, formulation) {
    own = std::move(equations);
  }
  void move() {
    RandomScene random(7, {});
    state = random.state(*scene.model, scene.initial);
    own = std::move(equations);
  }
  std::shared_ptr<const EquationsOfMotion> own;
};

TEST(Branches, on_threads_every_number_is_that_of_one_thread_to_the_last_bit) {
  for (const std::string formulation : {"ruthless", "quadratic", "exact"}) {
    for (const bool planar : {true, false}) {
      const SharedCase c(chains({14, 17, 9}, planar, !planar), formulation);
      const Given one = derivatives(*c.own, c.state);
      ASSERT_TRUE(one.evaluation.ok());
      for (const std::size_t threads : {2, 3, 4, 7}) {
        const BranchEquations branched = on_threads(c.own, threads);
        ASSERT_NE(branched.equations, nullptr) << branched.refusal;
        for (int again = 0; again < 5; ++again)
          expect_same(derivatives(*branched.equations, c.state), one,
                      formulation + ", " + std::to_string(threads) + " threads");
      }
    }
  }
}

TEST(Branches, random_trees_of_all_kinds_of_bodies_too) {
  int branched_trees = 0;
  for (const std::string formulation : {"ruthless", "quadratic"}) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
      const SceneWish wish{.bodies = 16 + static_cast<int>(seed % 12),
                           .planar = seed % 3 == 0,
                           .any_root = seed % 2 == 0,
                           .any_family = true};
      const SharedCase c(seed, wish, formulation);
      const BranchEquations branched = on_threads(c.own, 2 + seed % 2);
      if (branched.equations == nullptr) continue;
      ++branched_trees;
      expect_same(derivatives(*branched.equations, c.state), derivatives(*c.own, c.state),
                  formulation + ", seed " + std::to_string(seed));
    }
  }
  EXPECT_GT(branched_trees, 10);
}

TEST(Branches, a_state_without_accelerations_ends_as_on_one_thread) {
  SharedCase c(chains({12, 12, 12}, true, false), "quadratic");
  const BranchEquations branched = on_threads(c.own, 2);
  ASSERT_NE(branched.equations, nullptr);
  const std::vector<double> y = c.state.y;
  for (std::size_t i = 0; i < c.own->layout().positions; i += 5) {
    c.state.y = y;
    c.state.y[i] = std::numeric_limits<double>::quiet_NaN();
    const Given one = derivatives(*c.own, c.state);
    EXPECT_FALSE(one.evaluation.ok());
    expect_same(derivatives(*branched.equations, c.state), one, "not a number at " + std::to_string(i));
  }
}

TEST(Branches, two_callers_at_a_time_get_the_same_bits) {
  const SharedCase c(chains({20, 20, 20}, false, true), "quadratic");
  const BranchEquations branched = on_threads(c.own, 2);
  ASSERT_NE(branched.equations, nullptr);
  const Given one = derivatives(*c.own, c.state);
  std::vector<int> wrong(2, 0);
  std::vector<std::thread> callers;
  for (int& count : wrong)
    callers.emplace_back([&] {
      for (int i = 0; i < 300; ++i) count += derivatives(*branched.equations, c.state).bits == one.bits ? 0 : 1;
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong, std::vector<int>(2, 0));
}

TEST(Branches, equations_that_stay_on_one_thread_say_why) {
  const auto refusal = [](const std::string& text, const std::string& formulation) {
    return on_threads(SharedCase(text, formulation).own, 2).refusal;
  };
  EXPECT_EQ(refusal(chains({20}, true, false), "quadratic"), "its tree has no two branches of some size");
  EXPECT_EQ(refusal(chains({9, 9}, true, false), "consistent"),
            "the formulation is none of the symmetric ones, or loops are closed, or events lock hinges");
  EXPECT_EQ(refusal(chains({9, 9}, true, false), "rate-linear"), "the formulation drops products of speeds");
  EXPECT_THROW(on_threads(SharedCase(chains({9, 9}, true, false), "quadratic").own, 1), std::invalid_argument);
}

/// Whether a cut is one: every node once, branches hung on one node of the trunk, siblings of the trunk in it.
void expect_cut(const sweep::Branches& cut, const std::vector<int>& parents) {
  std::vector<std::size_t> group(parents.size(), std::numeric_limits<std::size_t>::max());
  std::vector<std::size_t> branch(parents.size(), 0);
  std::size_t branches = 0, covered = 0;
  const auto take = [&](const sweep::NodeRange& range, std::size_t of) {
    ++branches;
    for (std::size_t i = range.first; i < range.end; ++i, ++covered) {
      ASSERT_LT(i, parents.size());
      group[i] = of;
      branch[i] = branches;
    }
  };
  const std::size_t trunk = cut.of_thread.size();
  for (const sweep::NodeRange& range : cut.trunk) take(range, trunk);
  for (std::size_t k = 0; k < trunk; ++k)
    for (const sweep::NodeRange& range : cut.of_thread[k]) take(range, k);
  ASSERT_EQ(covered, parents.size());
  EXPECT_EQ(std::count(group.begin(), group.end(), std::numeric_limits<std::size_t>::max()), 0);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] < 0) {
      EXPECT_EQ(group[i], trunk);
      continue;
    }
    const auto parent = static_cast<std::size_t>(parents[i]);
    const bool in_trunk = group[i] == trunk, hangs_on_trunk = group[parent] == trunk;
    EXPECT_TRUE(hangs_on_trunk || (!in_trunk && branch[i] == branch[parent])) << i;
    for (std::size_t j = 0; j < i; ++j) {
      if (parents[j] == parents[i]) {
        EXPECT_EQ(group[j], group[i]) << j << " beside " << i;
      }
    }
  }
}

TEST(Branches, a_cut_gives_each_thread_whole_branches) {
  std::mt19937 random(5);
  for (int tree = 0; tree < 200; ++tree) {
    // Depth first: a node hangs on the last one, or on one that the last hangs on.
    const std::size_t n = 2 + random() % 60;
    std::vector<int> parents{-1};
    for (std::size_t i = 1; i < n; ++i) {
      int parent = static_cast<int>(i) - 1;
      while (parent >= 0 && random() % 4 == 0) parent = parents[static_cast<std::size_t>(parent)];
      parents.push_back(parent);
    }
    std::vector<double> costs(n);
    for (double& cost : costs) cost = 1.0 + static_cast<double>(random() % 5);
    for (const std::size_t threads : {1, 2, 3, 8}) {
      const sweep::Branches cut = sweep::cut_tree(parents, costs, threads);
      EXPECT_EQ(cut.of_thread.size(), threads);
      expect_cut(cut, parents);
      EXPECT_LE(cut.share, 1 + 1e-12);
      EXPECT_GE(cut.share, 1.0 / static_cast<double>(threads) - 1e-12);
    }
  }
}

TEST(Branches, a_cut_goes_through_the_stem_to_where_the_tree_parts) {
  // A stem of three, on which two chains of a hundred hang, one behind the other in the order of nodes.
  std::vector<int> parents{-1, 0, 1};
  for (int c = 0; c < 2; ++c)
    for (int i = 0; i < 100; ++i) parents.push_back(i == 0 ? 2 : static_cast<int>(parents.size()) - 1);
  const std::vector<double> costs(parents.size(), 1.0);
  const sweep::Branches cut = sweep::cut_tree(parents, costs, 2);
  EXPECT_NEAR(cut.share, (3 + 2 + 99) / 203.0, 1e-12);
  EXPECT_EQ(cut.of_thread[0].size(), 1);
  EXPECT_EQ(cut.of_thread[1].size(), 1);
}

}  // namespace
}  // namespace withy::test
