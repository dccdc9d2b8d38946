/// \file
/// Hinges of plugins that cease to say where they are: they are named, not masses, speeds or steps.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/simulation/made_scene.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// A slide along x that nobody inlines; beyond 0.4 m its pose is no number.
class CutSlide final : public Hinge {
 public:
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double> x, std::span<const double>, HingeMotion& out) const noexcept override {
    const double at = x[0] > 0.4 ? std::numeric_limits<double>::quiet_NaN() : x[0];
    out.pose = {Matrix3::Identity(), Vector3(at, 0, 0)};
    out.H.setZero(6, 1);
    out.H(3, 0) = 1;
    out.bias.setZero();
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override { return {}; }
};

/// A cart on it that carries a pendulum.
Made on_cut_slide(const std::string& integrator) {
  Made m("format: withy/1\ntime: {end: 1}\nintegrator: " + integrator + R"(
bodies:
  cart: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.1, 0, 0, 0]}
  rod: {type: rigid, mass: 1, center_of_mass: [0, -0.5, 0], inertia: [0.1, 0, 0.1, 0, 0, 0]}
hinges:
  track: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}
  pin: {type: revolute, axis: [0, 0, 1], parent: cart, child: rod}
)");
  std::vector<HingeNode> hinges = m.scene.model->hinges();
  hinges[0].hinge = std::make_shared<CutSlide>();
  m.scene.model = std::make_shared<const Model>(m.scene.model->bodies(), std::move(hinges), m.scene.model->gravity());
  m.equations = m.scene.formulation->compile(m.scene.model);
  return m;
}

/// \param x, rate of the slide [m, m/s]
State sliding(const Made& m, double x, double rate) {
  State state = m.scene.model->reference_state();
  state.y[m.scene.model->layout().hinges[0].position] = x;
  state.y[m.scene.model->layout().positions + m.scene.model->layout().hinges[0].speed] = rate;
  return state;
}

TEST(NonfiniteHinges, are_found_where_they_are_and_where_they_come_to) {
  const Made m = on_cut_slide("{name: dopri5, rtol: 1e-6}");
  EXPECT_FALSE(nonfinite_hinge(*m.scene.model, sliding(m, 0.3, 1), 0.05));
  const auto there = nonfinite_hinge(*m.scene.model, sliding(m, 0.5, 0), 0);
  ASSERT_TRUE(there);
  EXPECT_EQ(there->hinge, 0U);
  EXPECT_EQ(there->why, "the pose of hinge 'track' is not finite where its coordinate is 0.5");
  const auto ahead = nonfinite_hinge(*m.scene.model, sliding(m, 0.3, 1), 0.5);
  ASSERT_TRUE(ahead);
  EXPECT_THAT(ahead->why, HasSubstr("the pose of hinge 'track'"));
  // A coordinate that is no number is not the hinge's fault.
  EXPECT_FALSE(nonfinite_hinge(*m.scene.model, sliding(m, std::nan(""), 0), 0));
}

TEST(NonfiniteHinges, are_why_equations_cannot_be_solved) {
  const Made m = on_cut_slide("{name: dopri5, rtol: 1e-6}");
  EXPECT_FALSE(unsolvable_rate(*m.scene.model, *m.equations, sliding(m, 0.3, 0)));
  const auto rate = unsolvable_rate(*m.scene.model, *m.equations, sliding(m, 0.5, 0));
  ASSERT_TRUE(rate);
  EXPECT_EQ(rate->hinge, 0U);
  EXPECT_EQ(rate->why, "the pose of hinge 'track' is not finite where its coordinate is 0.5");
}

// From 0.2 m at 1 m/s it comes there, with steps of any size or of a given one.
TEST(NonfiniteHinges, are_named_where_a_run_ends_for_them) {
  for (const std::string integrator : {"{name: dopri5, rtol: 1e-6}", "{name: rk4, step: 1e-3}"}) {
    SCOPED_TRACE(integrator);
    const Made m = on_cut_slide(integrator);
    RunOptions options;
    options.end = 1;
    const RunSummary run =
        simulate(*m.scene.model, *m.equations, *m.scene.integrator, sliding(m, 0.2, 1), options, [](const State&) {});
    EXPECT_EQ(run.status, RunStatus::diverged);
    EXPECT_THAT(run.message, HasSubstr("the pose of hinge 'track' is not finite where its coordinate is"));
  }
}

}  // namespace
}  // namespace withy::test
