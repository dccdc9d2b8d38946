// Runs that are interrupted and taken up again: what they say of themselves is what the whole run says.
#include <gmock/gmock.h>

#include <optional>

#include "withy/study/run.hpp"
#include "withy/tests/study/plugins.hpp"
#include "withy/tests/study/scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;
using testing::HasSubstr;

/// A stiff arm that a spring swings to rest, in steps far too long for it: the run is another than the coarse one that
/// its formulations are chosen by at first, and comes to rest as that does.
SceneValues settling_arm() {
  return SceneValues::parse(R"(format: withy/1
gravity: [0, 0, 0]
time: {end: 8, output: 0.4}
formulation: {name: auto, accuracy: "10 %"}
integrator: {name: gauss, step: 0.4}
bodies:
  a: {type: beam, length: 1, mass_per_length: 1, damping_ratio: 0.1, bending_y: {stiffness: 3000, modes: 1}}
hinges:
  p: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
loads:
  k: {type: hinge-spring, hinge: p, stiffness: 60, damping: 0.4}
initial: {hinges: {p: {position: [1]}}}
)",
                            "settling.yaml");
}

TEST(ResumedRun, OfAutoKnowsHowFarTheWholeRunHasBeenFromTheCoarseOne) {
  const Prepared prepared = prepare(settling_arm(), plugins());
  const CertifiedRun whole = run(prepared, plugins());
  ASSERT_THAT(whole.summary.message, HasSubstr("The coarse run that its error is estimated by is"));

  RunSettings settings;
  double now = 0;
  std::optional<Checkpoint> late;
  settings.output = [&](const State& state, std::size_t) { now = state.time; };
  settings.control.interrupted = [&] { return now > 6; };
  settings.checkpoint = [&](const Checkpoint& checkpoint) { late = checkpoint; };
  ASSERT_EQ(run(prepared, plugins(), settings).summary.status, RunStatus::interrupted);
  ASSERT_TRUE(late);

  RunSettings resumed;
  resumed.resume = &*late;
  const CertifiedRun rest = run(prepared, plugins(), resumed);
  EXPECT_EQ(rest.summary.status, RunStatus::inaccurate);
  EXPECT_EQ(rest.summary.message, whole.summary.message);
}

// A checkpoint would be that of a run in the formulations of no plan.
TEST(ResumedRun, OfAutoIsNothingWhereItsFormulationsWereNotChosen) {
  const Prepared prepared = prepare(settling_arm(), plugins());
  RunSettings settings;
  int outputs = 0, checkpoints = 0;
  settings.output = [&](const State&, std::size_t) { ++outputs; };
  settings.control.interrupted = [] { return true; };
  settings.checkpoint = [&](const Checkpoint&) { ++checkpoints; };
  const RunSummary summary = run(prepared, plugins(), settings).summary;
  EXPECT_EQ(summary.status, RunStatus::interrupted);
  EXPECT_THAT(summary.message, HasSubstr("before it began"));
  EXPECT_EQ(summary.peak_effort.size(), prepared.model().layout().speeds);
  EXPECT_EQ(outputs + checkpoints, 0);
}

}  // namespace
}  // namespace withy::study
