/// \file
/// Motions that a host sets between steps: how they reach what is set, and what trees do that they drive.
#include <gmock/gmock.h>

#include <cmath>

#include "withy/core/simulation/session.hpp"
#include "withy/tests/loads/scene_run.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// A table whose hinge a host moves, at 0.3 rad and at rest at first; options of the motion follow.
std::string hosted_table(const std::string& options) {
  return turntable + "initial: {hinges: {axle: {position: [0.3]}}}\nmotions: {turn: {type: input, hinge: axle" +
         options + "}}\n";
}

/// A session of a scene in which a host sets what is called `turn`.
struct Hosted {
  explicit Hosted(const std::string& text)
      : loaded(text),
        session(*loaded.scene.model, *loaded.equations, *loaded.scene.integrator, loaded.scene.initial, {}) {
    for (std::size_t l = 0; l < loaded.scene.model->loads().size(); ++l)
      if (loaded.scene.model->loads()[l].name == "turn") input = l;
  }
  void to(double t, double value) {
    session.set_input(input, value);
    to(t);
  }
  void to(double t) { EXPECT_TRUE(session.advance(t, false).reached) << t; }
  double position() { return loaded.position(session.state(), "axle"); }
  double rate() { return loaded.rate(session.state(), "axle"); }
  /// That the motion needs at the present state [N m].
  double effort() {
    std::vector<double> efforts(loaded.equations->layout().speeds);
    Work work = loaded.equations->make_work();
    EXPECT_TRUE(loaded.equations->motion_efforts(session.state().time, session.state().y, efforts, work).ok());
    return efforts[loaded.hinge("axle").speed];
  }
  LoadedScene loaded;
  std::size_t input = 0;
  Session session;
};

/// Until it is set a hinge rests. Along q = 0.3 + 0.2 t², sampled at uneven times, the cubics are that parabola; after
/// the last one the rate stays, without effort. Along a sine rates are right to second order in the step.
TEST(MotionsOfHosts, reach_positions_along_cubics_of_second_order) {
  Hosted c(hosted_table(""));
  c.to(0.05);
  EXPECT_NEAR(c.position(), 0.3, 1e-12);
  EXPECT_EQ(c.session.input(c.input), c.position());
  Hosted p(hosted_table(""));
  for (const double t : {0.1, 0.25, 0.3, 0.5, 0.9}) {
    p.to(t, 0.3 + 0.2 * t * t);
    EXPECT_NEAR(p.position(), 0.3 + 0.2 * t * t, 1e-9) << t;
    EXPECT_NEAR(p.rate(), 0.4 * t, 1e-8) << t;
    EXPECT_NEAR(p.effort(), 0.2 * 0.4, 1e-8) << t;
    EXPECT_NEAR(p.session.input(p.input), p.position(), 1e-9);
  }
  p.to(1.5);
  EXPECT_NEAR(p.position(), 0.3 + 0.2 * 0.81 + 0.36 * 0.6, 1e-9);
  EXPECT_NEAR(p.effort(), 0, 1e-8);
  EXPECT_NEAR(p.session.state().y.back(), 0.5 * 0.2 * 0.36 * 0.36, 1e-9) << "work is the kinetic energy";
  double before = 0;
  for (const double h : {0.02, 0.01}) {
    Hosted s(hosted_table(""));
    double worst = 0;
    for (int k = 1; k * h < 1.5; ++k) {
      s.to(k * h, 0.3 + 0.1 * (1 - std::cos(4 * k * h)));
      worst = std::max(worst, std::abs(s.rate() - 0.4 * std::sin(4 * k * h)));
    }
    EXPECT_LT(worst, 1e-3);
    if (before > 0) {
      EXPECT_NEAR(before / worst, 4, 0.5);
    }
    before = worst;
  }
}

TEST(MotionsOfHosts, reach_rates_in_straight_lines_and_take_accelerations_at_once) {
  Hosted r(hosted_table(", sets: rate"));
  r.to(0.5, 1);
  EXPECT_NEAR(r.rate(), 1, 1e-9);
  EXPECT_NEAR(r.position(), 0.3 + 0.25, 1e-9);
  EXPECT_NEAR(r.effort(), 0.2 * 2, 1e-9);
  r.to(1);
  EXPECT_NEAR(r.rate(), 1, 1e-9);
  EXPECT_NEAR(r.position(), 0.55 + 0.5, 1e-9);
  EXPECT_NEAR(r.effort(), 0, 1e-9);
  Hosted a(hosted_table(", sets: acceleration"));
  a.to(0.5, 2);
  a.to(1);
  EXPECT_NEAR(a.rate(), 2, 1e-9) << "it holds";
  EXPECT_NEAR(a.position(), 0.3 + 1, 1e-9);
  Hosted l(hosted_table(", sets: acceleration, hold: linear"));
  l.to(0.5, 2);
  EXPECT_NEAR(l.rate(), 0.5, 1e-9);
  EXPECT_NEAR(l.position(), 0.3 + 2 * 0.25 / 6, 1e-9);
  l.to(1);
  EXPECT_NEAR(l.rate(), 1.5, 1e-9);
  EXPECT_THAT(problem_of(hosted_table(", hold: linear")), HasSubstr("a position is reached at the end of a step"));
  EXPECT_THAT(problem_of(hosted_table("") + "loads: {turn: {type: input, hinge: axle}}\n"),
              HasSubstr("which is that of a load"));
  EXPECT_THAT(problem_of(hosted_table("") + "loads: {servo: {type: pid, of: axle, to: turn, proportional: 1}}\n"),
              HasSubstr("turn"));
}

/// A flexible arm is moved as the dense equations with the same acceleration say, energy and work balance, and a
/// restored snapshot goes on bit by bit.
TEST(MotionsOfHosts, drive_flexible_trees_and_stand_in_snapshots) {
  for (const char* formulation : {"quadratic", "consistent", "exact"}) {
    Hosted c("format: withy/1\nformulation: " + std::string(formulation) + R"(
time: {end: 2}
integrator: {name: dopri5, rtol: 1e-9, atol: 1e-11}
bodies:
  hub: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}
  boom: {type: beam, length: 1, mass_per_length: 0.5, bending_y: {stiffness: 30, modes: 2}}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}
  elbow: {type: revolute, axis: [0, 0, 1], parent: hub, child: boom}
motions: {turn: {type: input, hinge: axle}}
)");
    const auto along = [](double t) { return 0.4 * (1 - std::cos(2 * t)); };
    for (int k = 1; k <= 20; ++k) c.to(0.05 * k, along(0.05 * k));
    const State& s = c.session.state();
    const auto seen = c.loaded.equations->make_observation();
    seen->observe(s.y);
    const Energies e = seen->energies();
    const double close = std::string(formulation) == "consistent" ? 1e-2 : 1e-7;
    EXPECT_NEAR(e.kinetic + e.potential, s.y.back(), close * e.kinetic) << formulation;
    std::vector<double> y_dot(c.loaded.equations->size());
    Work work = c.loaded.equations->make_work();
    ASSERT_TRUE(c.loaded.equations->derivatives(s.time, s.y, y_dot, work).ok());
    const DenseSystem dense = c.loaded.equations->system(s.time, s.y);
    ASSERT_EQ(dense.prescribed.size(), 1U);
    EXPECT_EQ(dense.prescribed[0].acceleration,
              y_dot[c.loaded.equations->layout().positions + dense.prescribed[0].speed]);
    EXPECT_GT(std::abs(dense.prescribed[0].acceleration), 0.1);
    const Checkpoint kept = c.session.snapshot();
    const auto go_on = [&] {
      c.to(1.07, along(1.07));
      c.to(1.3);
      return c.session.state().y;
    };
    const std::vector<double> once = go_on();
    c.session.restore(kept);
    EXPECT_EQ(go_on(), once) << formulation;
  }
}

}  // namespace
}  // namespace withy::test
