// States whose closed loops are open, on the way to small motions and as they are given, and loops that are held.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "withy/study/equilibrium.hpp"
#include "withy/study/frequencies.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/variation_text.hpp"
#include "withy/tests/simulation/four_bar.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

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
  const Prepared prepared = sprung_linkage({}, test::beam_coupler);
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
