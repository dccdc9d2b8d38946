// Whoever interrupts a sweep of modes keeps the values that were done, whole.
#include <gtest/gtest.h>

#include "withy/study/formulation_modes.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

/// What is found in two formulations at five lengths, if the user interrupts when `done` values are told.
ModesFound found_after(int done, ModesQuestion& question) {
  const Prepared prepared = prepare(scene("two-link-slew"), test::plugins());
  question.formulations = {"quadratic", "linear"};
  question.sweep = parse_sweep("bodies.link1.length=0.8:1.2:5", "sweep");
  question.holding.locked = {"shoulder", "elbow"};
  int told = 0;
  const Control control{[&told, done] { return told >= done; }, [&told](double, double) { ++told; }};
  return find_modes(prepared, test::plugins(), question, [&](const std::string&) { return control; });
}

TEST(InterruptedModes, KeepTheValuesThatWereDone) {
  ModesQuestion question, whole;
  const ModesFound all = found_after(100, whole);
  ASSERT_FALSE(all.interrupted);
  for (const int done : {3, 5, 7}) {
    const ModesFound found = found_after(done, question);
    EXPECT_TRUE(found.interrupted);
    ASSERT_EQ(found.runs.size(), done > 5 ? 2u : 1u) << done;
    ASSERT_EQ(found.against.size(), found.runs.size());
    std::size_t points = 0;
    for (std::size_t r = 0; r < found.runs.size(); ++r) {
      for (std::size_t k = 0; k < found.runs[r].points.size(); ++k, ++points) {
        const ModesAt &now = found.runs[r].points[k], &then = all.runs[r].points[k];
        EXPECT_EQ(now.value, then.value);
        ASSERT_EQ(now.modes.size(), then.modes.size());
        EXPECT_EQ(now.modes.front().eigenvalue, then.modes.front().eigenvalue);
      }
    }
    EXPECT_EQ(points, static_cast<std::size_t>(done));
  }
}

TEST(InterruptedModes, OfNoValueAreNone) {
  ModesQuestion question;
  const ModesFound found = found_after(0, question);
  EXPECT_TRUE(found.interrupted && found.runs.empty() && found.against.empty());
}

}  // namespace
}  // namespace withy::study
