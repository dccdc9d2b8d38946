// Cases make the same results whatever the jobs, the shards, the order and the company in lanes.
#include "withy/campaign/sweep_run.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/store.hpp"
#include "withy/results/results_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/campaign/store_fixture.hpp"
#include "withy/tests/simulation/wrapped_steps.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;
using test::plugins;
using testing::HasSubstr;

TEST(Sweeps, AreTheSameToTheLastByteWhateverTheJobsShardsAndOrder) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  EXPECT_TRUE(run(folder, plan, "one", {1, 1, 1, {}}).whole());
  const std::string table = table_of(folder, "one");
  EXPECT_THAT(table, HasSubstr("\n11,"));
  EXPECT_THAT(table, HasSubstr(",refused,")) << "a tolerance below zero";
  EXPECT_TRUE(run(folder, plan, "many", {5, 1, 1, {}}).whole());
  EXPECT_EQ(table_of(folder, "many"), table);
  for (const std::uint64_t shard : {3U, 1U, 2U}) EXPECT_TRUE(run(folder, plan, "parts", {2, shard, 3, {}}).whole());
  EXPECT_EQ(table_of(folder, "parts"), table);
  EXPECT_EQ(folder.read("parts/failed.csv"), folder.read("many/failed.csv"));
  EXPECT_EQ(folder.read("parts/statistics.csv"), folder.read("many/statistics.csv"));
  EXPECT_EQ(run(folder, plan, "parts", {2, 1, 1, {}}).ran, 0U) << "all is there, whatever the shards were";
  // A case alone.
  const Cases cases(plan);
  StoreIndex index(folder / "many", read_description(folder / "many"));
  for (const std::uint64_t i : {4U, 9U}) {
    CaseResult alone = run_case(plan, cases, i, plugins(), {}), kept = *index.read(i);
    alone.seconds = kept.seconds = 0;
    EXPECT_EQ(encode(alone), encode(kept));
  }
}

TEST(Sweeps, RefuseTheCasesWhoseValuesDoNotGoTogether) {
  const PlanFolder folder;
  const Plan plan =
      folder.plan(R"(vary: {bodies.rod.inertia.2: {grid: [0.2, 0.3]}, bodies.rod.inertia.0: {grid: [0.3, 0.2]}}
keep: {final: [pivot]}
)");
  EXPECT_EQ(run(folder, plan, "store", {1, 1, 1, {}}).failed, 2U);
  const std::string table = table_of(folder, "store");
  for (const char* row :
       {"\n0,refused,0.2,0.3,", "\n1,completed,0.2,0.2,", "\n2,completed,0.3,0.3,", "\n3,refused,0.3,0.2,"})
    EXPECT_THAT(table, HasSubstr(row));
}

/// Cases of the driven arm: of two integrators with steps of their own, some of them too long, of two structures and of
/// a formulation without lanes, so that lanes end early, run empty, are filled anew and wait for each other.
Plan arm_plan(const PlanFolder& folder, const std::string& more) {
  folder.write("arm.yaml", "format: withy-sweep/1\nscene: " WITHY_SOURCES "/scenes/driven-arm.yaml\n" + more + R"(
set: {time.end: 0.3}
vary:
  formulation: {grid: [quadratic, ruthless, exact]}
  bodies.link1.bending_y.modes: {grid: [2, 3]}
  integrator: {grid: [{name: rk4, step: 0.009}, {name: dopri5, rtol: 1e-6, atol: 1e-8}]}
  bodies.payload.mass: {uniform: {from: 1, to: 3}}
cases: 3
keep: {final: [shoulder, elbow], peak: [link2.tip.deflection_y, elbow.rate]}
)");
  return read_plan((folder / "arm.yaml").string(), plugins());
}

TEST(Sweeps, InLanesAreTheSameToTheLastByteWhateverTheCompany) {
  const PlanFolder folder;
  const Plan plan = arm_plan(folder, "evaluation: in-lanes\n");
  const SweepOutcome one = run(folder, plan, "one", {1, 1, 1, {}});
  EXPECT_EQ(one.ran, 36U);
  EXPECT_EQ(one.alone, 12U);
  EXPECT_EQ(one.alone_because, "a beam moves by exact kinematics");
  const std::string table = table_of(folder, "one");
  EXPECT_THAT(table, testing::Not(HasSubstr("refused")));
  run(folder, plan, "many", {3, 1, 1, {}});
  EXPECT_EQ(table_of(folder, "many"), table);
  EXPECT_THAT(folder.read("one/failed.csv"), HasSubstr("diverged"));
  EXPECT_EQ(folder.read("many/failed.csv"), folder.read("one/failed.csv"));
  for (const std::uint64_t shard : {5U, 2U, 4U, 1U, 3U}) run(folder, plan, "parts", {1, shard, 5, {}});
  EXPECT_EQ(table_of(folder, "parts"), table);
  const Cases cases(plan);
  StoreIndex index(folder / "one", read_description(folder / "one"));
  for (const std::uint64_t i : {0U, 4U, 8U, 23U}) {
    CaseResult alone = run_case(plan, cases, i, plugins(), {}), kept = *index.read(i);
    alone.seconds = kept.seconds = 0;
    EXPECT_EQ(encode(alone), encode(kept)) << "case " << i;
  }
}

TEST(Sweeps, InLanesAgreeWithCasesByThemselvesToRounding) {
  const PlanFolder folder;
  const Plan in_lanes = arm_plan(folder, "evaluation: in-lanes\n");
  run(folder, in_lanes, "lanes", {1, 1, 1, {}});
  const Plan alone = arm_plan(folder, "evaluation: one-at-a-time\n");
  EXPECT_THROW(Store(folder / "lanes", alone, false), ResultsError) << "one store has results of one kind";
  EXPECT_EQ(run(folder, alone, "alone", {1, 1, 1, {}}).alone, 36U);
  StoreIndex first(folder / "lanes", read_description(folder / "lanes"));
  StoreIndex second(folder / "alone", read_description(folder / "alone"));
  int completed = 0;
  for (std::uint64_t i = 0; i < 36; ++i) {
    const CaseResult a = *first.read(i), b = *second.read(i);
    EXPECT_EQ(a.status, b.status) << "case " << i;
    if (!a.completed() || !b.completed()) continue;
    ++completed;
    // The last is a peak over steps, whose places rounding moves where they are chosen by error.
    for (std::size_t k = 0; k < a.numbers.size(); ++k)
      EXPECT_NEAR(a.numbers[k], b.numbers[k], (k + 1 < a.numbers.size() ? 1e-9 : 1e-3) * (1 + std::abs(b.numbers[k])))
          << "case " << i;
  }
  EXPECT_GE(completed, 24);
}

TEST(Sweeps, EndLanesThatAreAtWorkWhereTheyAreInterrupted) {
  const PlanFolder folder;
  const Plan plan = arm_plan(folder, "evaluation: in-lanes\n");
  SweepSettings settings{1, 1, 1, {}};
  int asked = 0;
  settings.control.interrupted = [&] { return ++asked > 300; };
  const SweepOutcome outcome = run(folder, plan, "store", settings);
  EXPECT_FALSE(outcome.whole());
  EXPECT_EQ(run(folder, plan, "store", {2, 1, 1, {}}).before, outcome.ran);
  run(folder, plan, "whole", {1, 1, 1, {}});
  EXPECT_EQ(table_of(folder, "store"), table_of(folder, "whole"));
}

/// 1500 N m s/rad on 1e-9 kg m²: the case ends after a second of work with its reason, and the plan goes on.
TEST(Cases, ThatAreTooStiffForTheirIntegratorStopEarly) {
  const PlanFolder folder;
  folder.write("stiff.yaml", R"(format: withy/1
time: {end: 1}
bodies: {wheel: {type: rigid, mass: 1, inertia: [1, 1, 1.0e-9, 0, 0, 0]}}
hinges: {pin: {type: revolute, axis: [0, 0, 1], parent: world, child: wheel}}
loads: {drag: {type: hinge-spring, hinge: pin, stiffness: 1.0e-6, damping: 1}}
initial: {hinges: {pin: {rate: [1]}}}
)");
  folder.write("plan.yaml",
               "format: withy-sweep/1\nscene: stiff.yaml\nvary: {loads.drag.damping: {grid: [1.0e-9, 1500]}}\n"
               "keep: {final: [pin]}\n");
  const Plan plan = read_plan((folder / "plan.yaml").string(), plugins());
  const Cases cases(plan);
  EXPECT_TRUE(run_case(plan, cases, 0, plugins(), {}).completed());
  const CaseResult stiff = run_case(plan, cases, 1, plugins(), {});
  EXPECT_EQ(stiff.status, "too-stiff");
  EXPECT_THAT(stiff.message, HasSubstr("its fastest motion is -1.5e+12/s: damping of load 'drag' on pin"));
}

class FailingSteps final : public test::WrappedSteps {
 public:
  using WrappedSteps::WrappedSteps;
  StepResult step(double /*t_limit*/) override { throw std::runtime_error("out of order"); }
};

/// The project's plugins with an integrator of such steps.
Registry& with_failing() {
  static const PluginHost host({PluginHost::default_directory()});
  static Registry* const registry = [] {
    auto* made = new Registry;  // plugins stay for the life of the process
    host.attach(*made);
    Enrollment e;
    e.add(Plugin<Integrator>{"failing", "as dopri5", {}, [](const Value&, const MakeContext&) {
                               return std::unique_ptr<Integrator>(
                                   std::make_unique<test::WrappedIntegrator<FailingSteps>>(
                                       study::make_integrator(plugins(), "dopri5", 1e-6)));
                             }});
    made->admit(std::move(e), "test");
    return made;
  }();
  return *registry;
}

TEST(Sweeps, EndWithTheNameOfAnIntegratorThatFails) {
  const PlanFolder folder;
  folder.write("fails.yaml", "format: withy-sweep/1\nscene: " WITHY_SOURCES R"(/scenes/pendulum.yaml
set: {time.end: 0.5, integrator: {name: failing}}
vary: {bodies.rod.mass: {grid: [1, 2]}}
keep: {final: [pivot]}
)");
  const Plan plan = read_plan((folder / "fails.yaml").string(), with_failing());
  try {
    static_cast<void>(run_sweep(plan, with_failing(), Store(folder / "fails", plan, false), {1, 1, 1, {}}));
    FAIL() << "no case can be trusted";
  } catch (const PluginError& e) {
    EXPECT_STREQ(e.what(), "integrator 'failing' does not step: out of order");
  }
}

}  // namespace
}  // namespace withy::campaign
