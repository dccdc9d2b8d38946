/// \file
/// The slew of scenes/extended-slew.yaml: the two-link arm stretched out, as one beam.
#include <cmath>
#include <numbers>

#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

using std::numbers::pi;

/// ρ (b² − a²)/2 and ρ (b³ − a³)/3 of a link from a to b.
double first_moment(double rho, double a, double b) { return rho * (b * b - a * a) / 2; }
double second_moment(double rho, double a, double b) { return rho * (b * b * b - a * a * a) / 3; }

/// The rigid arm turns as one body: its efforts are its moments of inertia times the acceleration, whose peak in the
/// quintic law is 10/√3 Δ/T². Outputs every 0.1 ms miss the peak's parabola by less than 1e-7.
TEST(ExtendedSlew, efforts_are_those_of_one_rigid_body) {
  const LoadedScene scene(shipped("extended-slew.yaml"));
  const double elbow = 0.0762 + 0.9144 + 0.0762, root = elbow + 0.0127, tip = root + 0.9144, payload = tip + 0.0508;
  const double outer = second_moment(0.669685, root, tip) + 2 * payload * payload + 0.01;
  const double inner = second_moment(1.33937, 0.0762, 0.0762 + 0.9144) + 14 * elbow * elbow + 0.03 + 0.01;
  const double about_elbow = outer - elbow * (first_moment(0.669685, root, tip) + 2 * payload);
  const double peak = 10 / std::sqrt(3.0) * (pi / 3) / (3.8 * 3.8);
  const std::vector<const BoundLoad*> loads = [&] {
    std::vector<const BoundLoad*> all;
    for (const auto& load : scene.scene.model->loads()) all.push_back(load.load.get());
    return all;
  }();
  ASSERT_EQ(loads.size(), 1U);
  const Layout& layout = scene.scene.model->layout();
  double shoulder = 0, at_elbow = 0;
  for (int i = 0; i <= 38000; ++i) {
    const std::vector<double>& y = scene.scene.initial.y;
    std::vector<double> tau(layout.speeds), scratch(loads[0]->scratch());
    loads[0]->add(1e-4 * i, std::span(y).first(layout.positions), std::span(y).subspan(layout.positions), tau, scratch);
    shoulder = std::max(shoulder, std::abs(tau[scene.hinge("shoulder").speed]));
    at_elbow = std::max(at_elbow, std::abs(tau[scene.hinge("elbow").speed]));
  }
  EXPECT_NEAR(shoulder / (peak * (inner + outer)), 1, 1e-6);
  EXPECT_NEAR(at_elbow / (peak * about_elbow), 1, 1e-6);
}

/// Stretched out, the links carry the centrifugal forces of the whole arm: without their stiffening (inconsistent) the
/// slew diverges, as the folded one does; with it, the strict form lasts, where it fails in the folded slew at 1.2.
TEST(ExtendedSlew, lasts_where_stiffening_is_known) {
  for (const char* scale : {"1.0", "1.2"}) {
    const auto arm = [&](const std::string& formulation) {
      return LoadedScene(shipped("extended-slew.yaml"),
                         {"formulation=" + formulation, std::string("loads.slew.time_scale=") + scale});
    };
    LoadedScene exact = arm("exact"), quadratic = arm("quadratic"), consistent = arm("consistent");
    const State truth = exact.run().back();
    const auto away = [&](LoadedScene& c) {
      const State end = c.run().back();
      return std::hypot(c.position(end, "shoulder") - exact.position(truth, "shoulder"),
                        c.position(end, "elbow") - exact.position(truth, "elbow")) *
             180 / pi;
    };
    // Measured: 0.0014 and 0.0055 degrees; 0.018 and 0.067.
    EXPECT_LT(away(quadratic), 0.01) << scale;
    EXPECT_LT(away(consistent), 0.1) << scale;
    LoadedScene inconsistent = arm("inconsistent");
    RunOptions options;
    options.end = end_of_run(inconsistent.scene);
    options.output = inconsistent.scene.output;
    const RunSummary summary =
        simulate(*inconsistent.scene.model, *inconsistent.equations, *inconsistent.scene.integrator,
                 inconsistent.scene.initial, options, [](const State&) {});
    EXPECT_NE(summary.status, RunStatus::completed) << scale;
  }
}

}  // namespace
}  // namespace withy::test
