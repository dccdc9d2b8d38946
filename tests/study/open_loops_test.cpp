// States whose closed loops are open, on the way to small motions and as they are given, and loops that are held.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "withy/scene/state_as_given.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/frequencies.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/simulation/four_bar.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using testing::HasSubstr;

/// A linkage at rest with a spring at its rocker, and the force in its last pin.
Prepared sprung_linkage(const std::vector<std::string>& changes = {},
                        const std::string& coupler = test::rigid_coupler) {
  SceneValues values = SceneValues::parse(test::four_bar(coupler, "dopri5"), "text");
  values.set_text("initial.hinges.motor={position: [1.6]}");
  values.set_text("loads.torque={type: hinge-spring, hinge: pivot, stiffness: 40, damping: 0.2, free_position: 1.5}");
  values.set_text("outputs.pin={type: reaction, constraint: loop}");
  for (const std::string& change : changes) values.set_text(change);
  return prepare(std::move(values), test::plugins());
}

StateAsGiven given(const Prepared& prepared, const std::string& text) {
  return parse_state_as_given(text, "state", prepared.scene);
}

double greatest_gap(const Prepared& prepared, const State& state) {
  const ClosedLoops& loops = test::loops_of(*prepared.equations);
  const std::size_t equations = loops.closing_equations(), speeds = prepared.model().layout().speeds;
  std::vector<double> gaps(equations), rates(equations), J(equations * speeds);
  Work work = prepared.equations->make_work();
  loops.see(state.y, gaps, rates, J, work);
  double most = 0;
  for (const double gap : gaps) most = std::max(most, std::abs(gap));
  return most;
}

void expect_same_model(const LinearModel& a, const LinearModel& b) {
  EXPECT_LE((a.system.A - b.system.A).norm(), 1e-9 * b.system.A.norm());
  EXPECT_LE((a.system.C - b.system.C).norm(), 1e-8 * b.system.C.norm());
  for (std::size_t k = 0; k < a.output_values.size(); ++k) EXPECT_NEAR(a.output_values[k], b.output_values[k], 1e-9);
}

// Statics of the rigid frame that is left: a moment on the rocker is held by a force along the coupler.
TEST(OpenLoops, AHeldLoopAnswersEffortsByItsReactionsAlone) {
  const Prepared prepared = sprung_linkage();
  const LinearModel m =
      linear_model(Configuration(prepared, prepared.scene.initial, {{"motor"}, {}}), {{"pivot"}, {"pin"}});
  EXPECT_TRUE(m.states.empty());
  const test::Linkage::Place at = test::Linkage::place(1.6);
  const double lever = 0.8 * std::sin(at.coupler - at.rocker);
  EXPECT_NEAR(m.system.D(find(m.outputs, "pin.fx"), 0), -1 / lever, 1e-10);
  EXPECT_NEAR(m.system.D(find(m.outputs, "pin.fy"), 0), 0, 1e-10);
}

TEST(OpenLoops, StatesThatNameOneCoordinateAreThoseOfASceneThatBeginsThere) {
  // With a load whose own state begins where its hinge is.
  const std::string servo = "loads.servo={type: pid, hinge: pivot, proportional: 3, derivative: 2, filter: 0.1}";
  const Prepared here = sprung_linkage({servo}), there = sprung_linkage({servo, "initial.hinges.motor.position=[1.2]"});
  const Configuration c(here, given(here, "{hinges: {motor: {position: 1.2}}}"), {});
  EXPECT_EQ(c.state().y[0], 1.2) << "what is named stays";
  EXPECT_THAT(c.closing(), HasSubstr("positions changed, most 'elbow' by"));
  EXPECT_LT(greatest_gap(here, c.state()), 1e-13);
  for (std::size_t i = 0; i < c.state().y.size(); ++i)
    EXPECT_NEAR(c.state().y[i], there.scene.initial.y[i], 1e-12) << i;
  expect_same_model(linear_model(c, {{"motor"}, {}}), linear_model(at_start(there), {{"motor"}, {}}));
  EXPECT_EQ(Configuration(there, there.scene.initial, {}).closing(), "");
}

TEST(OpenLoops, StatesOfOtherLengthsAreClosedAndWhatIsLockedStays) {
  const Prepared before = sprung_linkage(), after = sprung_linkage({"bodies.rocker.frames.pin.position.0=0.9"});
  const std::string kept = write_state(before.model(), before.scene.initial);
  EXPECT_GT(greatest_gap(after, given(after, kept).state), 0.08);
  const ModesAt modes = modes_at({after, given(after, kept), {}}, true);
  EXPECT_EQ(modes.problem, "");
  for (const bool locked : {false, true}) {
    const Configuration c(after, given(after, kept),
                          {locked ? std::vector<std::string>{"motor"} : std::vector<std::string>(), {}});
    EXPECT_THAT(c.closing(), HasSubstr("Loops were closed at the start: positions changed, most"));
    EXPECT_LT(greatest_gap(after, c.state()), 1e-13);
    EXPECT_EQ(c.state().y[0] == 1.6, locked);
    const Prepared same = sprung_linkage({"bodies.rocker.frames.pin.position.0=0.9",
                                          "initial.hinges.motor.position=[" + fmt::format("{}", c.state().y[0]) + "]"});
    expect_same_model(
        linear_model(c, {{"pivot"}, {"pin"}}),
        linear_model(Configuration(same, same.scene.initial, {c.held_names(), {}}), {{"pivot"}, {"pin"}}));
  }
}

TEST(OpenLoops, WhatCarriesALoopStays) {
  std::string carried = test::four_bar(test::rigid_coupler, "dopri5");
  carried = test::replaced(carried, "parent: world, child: crank", "parent: sled, child: crank");
  carried = test::replaced(carried, "parent: world, child: rocker", "parent: sled, child: rocker");
  carried =
      test::replaced(carried, "bodies:\n", "bodies:\n  sled: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}\n");
  carried = test::replaced(carried, "hinges:\n",
                           "hinges:\n  rail: {type: prismatic, axis: [1, 0, 0], parent: world, child: sled}\n");
  carried = test::replaced(carried, ", rate: [6]", "");
  const Prepared prepared = prepare(SceneValues::parse(carried, "text"), test::plugins());
  const Configuration c(
      prepared,
      given(prepared,
            "{hinges: {rail: {position: 0.3, rate: 2}, motor: {position: 1.2}, elbow: {position: -1}, "
            "pivot: {position: 1.4}}}"),
      {});
  EXPECT_THAT(c.closing(), HasSubstr("positions changed, most"));
  EXPECT_LT(greatest_gap(prepared, c.state()), 1e-13);
  EXPECT_EQ(c.state().y[prepared.model().layout().hinge("rail")->position], 0.3);
}

TEST(OpenLoops, StatesThatCannotBeClosedAreRefusedWithTheDistance) {
  const Prepared prepared = sprung_linkage();
  const std::string folded =
      "{hinges: {motor: {position: 0}, elbow: {position: 0}, pivot: {position: 3.141592653589793}}}";
  try {
    Configuration(prepared, given(prepared, folded), {{"motor", "elbow"}, {}});
    FAIL();
  } catch (const InputError& e) {
    // The coupler's end is at 1.3 m, the rocker's at 0.1 m, and it comes to 1.7 m at most: not to 1.3 m at a height of
    // 0.
    EXPECT_THAT(
        e.what(),
        HasSubstr("constraint 'loop': the loop cannot be closed from this start: its frames are 1.2 m apart there"));
    EXPECT_THAT(e.what(), testing::Not(HasSubstr("`guess`")));
  }
}

TEST(OpenLoops, ASampledLoadIsNotAskedWhereNoLoopCloses) {
  const Prepared prepared =
      sprung_linkage({"loads.ctl={type: pid, of: pin.fx, hinge: pivot, proportional: 0.01, sample: 0.01}"});
  const Equilibrium found = find_equilibrium(at_start(prepared), {}, test::plugins());
  ASSERT_EQ(found.problem, "");
  // It pushes a hundredth of that force, against it; nothing accelerates.
  const State& state = found.steady.state;
  EXPECT_LT(greatest_gap(prepared, state), 1e-13);
  const LinearModel m = linear_model({prepared, state, {}}, {{}, {"pin"}});
  EXPECT_TRUE(m.equilibrium);
}

TEST(OpenLoops, FrequenciesOfBodiesWithoutExactKinematicsAreReferredToQuadratic) {
  const Prepared prepared =
      sprung_linkage({}, "{type: plate, length: 1.0, width: 0.2, mass_per_area: 2.7, stiffness: 50, modes: 2}");
  FrequencyQuestion question;
  Point point;
  point.formulation = "symmetric";
  point.modes = 2;
  question.points = {point};
  question.sweep = parse_sweep("loads.torque.free_position=1.5:1.6:2", "sweep");
  FrequencyStudy study(prepared, test::plugins(), question);
  EXPECT_EQ(study.reference().formulation, "quadratic");
  EXPECT_LT(study.error(point, study.names().front(), 1.6), 0.01);
}

}  // namespace
}  // namespace withy::study
