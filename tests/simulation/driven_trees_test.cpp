/// \file
/// Trees that motions drive: what their hinges do is known, and so is the work that it takes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

/// A rod that hangs down under its weight; a motion moves its hinge.
std::string driven_rod(const std::string& motion, const std::string& integrator) {
  return R"(
format: withy/1
time: {end: 3}
gravity: [0, -9.81, 0]
integrator: )" +
         integrator + R"(
bodies:
  rod: {type: rigid, mass: 1.2, center_of_mass: [0, -0.5, 0], inertia: [0.1, 0, 0.1, 0, 0, 0]}
hinges:
  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: rod}
motions:
  turn: )" +
         motion + '\n';
}

RunSummary run_of(const Made& m, double end, double output) {
  RunOptions options;
  options.end = end;
  options.output = output;
  options.drift_limit = 1e-6;
  return simulate(*m.scene.model, *m.equations, *m.scene.integrator, m.scene.initial, options, {});
}

// Nothing but the work is integrated: m g c (1 - cos wt). Errors of steps add up, of some hundred here.
TEST(DrivenTrees, the_work_is_held_to_the_tolerance_where_nothing_else_is_to_be_found) {
  for (const std::string integrator : {"dopri5", "dop853", "rk4-adaptive", "radau", "imex", "rosenbrock-w"}) {
    SCOPED_TRACE(integrator);
    const Made m(driven_rod("{type: constant-rate, hinge: pivot, rate: 10}",
                            "{name: " + integrator + ", rtol: 1e-8, atol: 1e-9}"));
    const double end = 2.3;
    const RunSummary summary = run_of(m, end, end);
    EXPECT_EQ(summary.status, RunStatus::completed) << summary.message;
    const double weight = 1.2 * 9.81 * 0.5;
    EXPECT_NEAR(summary.final.y.back(), weight * (1 - std::cos(10 * end)), 100 * 1e-8 * weight);
  }
}

// Steps pass over a pulse that lasts for less than a 4096th of the run, and over a kink that the law does not tell of.
TEST(DrivenTrees, a_hinge_that_has_left_its_motion_is_told_and_the_run_inaccurate) {
  const std::string pulse = "{type: expression, hinge: pivot, value: 'exp(-((t - 1.6)/1e-5)^2)'}",
                    kink = "{type: expression, hinge: pivot, value: 'min(t, 1)'}";
  const auto ended = [](const std::string& motion) {
    return run_of(Made(driven_rod(motion, "{name: dopri5, rtol: 1e-6}")), 3, 0.1);
  };
  for (const std::string& motion : {pulse, kink}) {
    SCOPED_TRACE(motion);
    const RunSummary passed_over = ended(motion);
    EXPECT_EQ(passed_over.status, RunStatus::inaccurate);
    EXPECT_NE(passed_over.message.find("Hinge 'pivot' is off its motion 'turn' by"), std::string::npos)
        << passed_over.message;
  }
  const RunSummary seen = ended("{type: expression, hinge: pivot, value: 'exp(-((t - 1.5)/0.01)^2)'}");
  EXPECT_EQ(seen.status, RunStatus::completed) << seen.message;
}

/// Goes on evenly, and ceases to say where.
class LostMotion final : public Motion {
 public:
  bool locks() const override { return false; }
  MotionPoint at(double t) const noexcept override {
    return {t > 1 ? std::numeric_limits<double>::quiet_NaN() : t, 1, 0};
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
};

TEST(DrivenTrees, a_law_without_a_coordinate_makes_the_run_inaccurate_and_is_named) {
  Made m(driven_rod("{type: constant-rate, hinge: pivot, rate: 1}", "{name: dopri5, rtol: 1e-9}"));
  Model model(m.scene.model->bodies(), m.scene.model->hinges(), m.scene.model->gravity());
  model.add_motion("lost", "pivot", std::make_shared<LostMotion>());
  m.scene.model = std::make_shared<const Model>(std::move(model));
  m.equations = m.scene.formulation->compile(m.scene.model);
  const RunSummary kept = run_of(m, 0.9, 0.1), lost = run_of(m, 2, 0.1);
  EXPECT_EQ(kept.status, RunStatus::completed) << kept.message;
  EXPECT_EQ(lost.status, RunStatus::inaccurate);
  EXPECT_NE(lost.message.find("Motion 'lost' has no finite coordinate at t = "), std::string::npos) << lost.message;
  EXPECT_EQ(kept.lost_motion.name, "");
  EXPECT_EQ(lost.lost_motion.name, "lost");
  EXPECT_GT(lost.lost_motion.time, 1);
  EXPECT_LE(lost.lost_motion.time, 1.1) << "the first output after it is lost";
}

}  // namespace
}  // namespace withy::test
