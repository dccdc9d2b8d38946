#include <cmath>
#include <numbers>

#include "withy/tests/conformance/allocations.hpp"
#include "withy/tests/conformance/load_suite.hpp"
#include "withy/tests/loads/load_plugins.hpp"

namespace withy {
namespace {

using std::numbers::pi;

/// Shoulder 0 → 60°, elbow 135° → 0°, 3.8 s before scaling.
std::unique_ptr<Load> slew(double time_scale) {
  Registry registry = load_registry();
  const auto target = [](double from, double to) {
    return Value::map({{"from", Value(from * pi / 180)}, {"to", Value(to * pi / 180)}});
  };
  return make_plugin<Load>(registry, "rigid-inverse-dynamics",
                           {{"duration", Value(3.8)},
                            {"time_scale", Value(time_scale)},
                            {"hinges", Value::map({{"shoulder", target(0, 60)}, {"elbow", target(135, 0)}})}});
}

std::vector<double> slew_efforts(const Model& model, const BoundLoad& load, double t) {
  std::vector<double> y = model.reference_state().y, tau(model.layout().speeds), scratch(load.scratch(), NAN);
  load.add(t, std::span(y).first(model.layout().positions), std::span(y).subspan(model.layout().positions), tau,
           scratch);
  return tau;
}

/// Greatest |effort| over the motion, sampled so finely that the parabola at the peak is missed by less than 1e-6.
std::vector<double> peaks(const Model& model, const BoundLoad& load) {
  std::vector<double> peak(model.layout().speeds);
  for (int i = 0; i <= 4000; ++i) {
    const std::vector<double> tau = slew_efforts(model, load, load.end() * i / 4000);
    for (std::size_t k = 0; k < tau.size(); ++k) peak[k] = std::max(peak[k], std::abs(tau[k]));
  }
  return peak;
}

// The peaks of Padilla & von Flotow's slew, given to four digits by an independent computation with the closed-form
// equations of the rigid arm (theory, section 3).
TEST(RigidInverseDynamics, peak_efforts_of_the_papers_slew) {
  const double expected[][3] = {{1.0, 7.107, 1.640}, {1.2, 10.235, 2.361}, {0.1685, 0.2018, 0.0466}};
  const double last_digit[] = {1e-3, 1e-3, 1e-4};
  for (int i = 0; i < 3; ++i) {
    const Model model = two_link_arm(0);
    const auto load = slew(expected[i][0])->bind(model);
    const std::vector<double> peak = peaks(model, *load);
    ASSERT_EQ(peak.size(), 2u);
    EXPECT_NEAR(peak[0], expected[i][1], 0.6 * last_digit[i]);
    EXPECT_NEAR(peak[1], expected[i][2], 0.6 * last_digit[i]);
  }
}

TEST(RigidInverseDynamics, efforts_on_flexible_bodies_are_those_of_the_rigid_tree) {
  const Model rigid = two_link_arm(0), flexible = two_link_arm(2);
  const auto a = slew(1.2)->bind(rigid), b = slew(1.2)->bind(flexible);
  ASSERT_EQ(flexible.layout().speeds, 6u);
  for (const double t : {0.3, 1.0, 2.9}) {
    const std::vector<double> r = slew_efforts(rigid, *a, t), f = slew_efforts(flexible, *b, t);
    const std::vector<double> expected = {r[0], 0, 0, r[1], 0, 0};
    // Inertias are summed in another order: a few units in the last place.
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(f[i], expected[i], 1e-13 * std::abs(r[0]));
  }
}

// Without gravity efforts are inertial: τ(t; α) = α² τ(αt; 1).
TEST(RigidInverseDynamics, efforts_grow_with_the_square_of_the_time_scale) {
  const Model model = two_link_arm(0);
  const auto slow = slew(1)->bind(model), fast = slew(2)->bind(model);
  EXPECT_EQ(fast->end(), 1.9);
  EXPECT_EQ(fast->discontinuities(), (std::vector<double>{0, 1.9}));
  for (const double t : {0.1, 0.7, 1.3}) {
    const std::vector<double> f = slew_efforts(model, *fast, t), s = slew_efforts(model, *slow, 2 * t);
    EXPECT_NEAR(f[0], 4 * s[0], 1e-12);
    EXPECT_NEAR(f[1], 4 * s[1], 1e-12);
  }
}

TEST(RigidInverseDynamics, after_the_end_nothing_is_left_without_gravity_and_the_weight_with_it) {
  const Model model = two_link_arm(0);
  EXPECT_EQ(slew_efforts(model, *slew(1)->bind(model), 3.8), (std::vector<double>{0, 0}));
  const Model heavy(model.bodies(), model.hinges(), {0, -9.81, 0});
  // Both links in a straight line at 60°: moments of the weights about shoulder and elbow.
  const double c = std::cos(pi / 3) * 9.81;
  const double link1 = 0.9144 * 1.33937, link2 = 0.9144 * 0.669685;
  const double elbow_at = 0.0762 + 0.9144 + 0.0762;
  const double elbow = link2 * (0.0127 + 0.4572) + 2 * (0.0127 + 0.9144 + 0.0508);
  const double shoulder = link1 * (0.0762 + 0.4572) + 14 * (0.0762 + 0.9144 + 0.0762) + elbow + (link2 + 2) * elbow_at;
  for (const double t : {3.8, 100.0}) {
    const std::vector<double> tau = slew_efforts(heavy, *slew(1)->bind(heavy), t);
    EXPECT_NEAR(tau[0], shoulder * c, 1e-12 * shoulder * c);
    EXPECT_NEAR(tau[1], elbow * c, 1e-12 * elbow * c);
  }
}

TEST(RigidInverseDynamics, the_motion_begins_where_it_is_said_to) {
  const Model model = two_link_arm(2);
  State state = model.reference_state();
  state.y[1] = 0.25;  // a modal coordinate keeps its value
  slew(1)->bind(model)->begin(state);
  EXPECT_EQ(state.y[model.layout().hinge("shoulder")->position], 0.0);
  EXPECT_EQ(state.y[model.layout().hinge("elbow")->position], 135 * pi / 180);
  EXPECT_EQ(state.y[1], 0.25);
}

TEST(RigidInverseDynamics, adds_to_the_efforts_there_are_and_allocates_nothing) {
  const Model model = two_link_arm(2);
  const auto load = slew(1)->bind(model);
  const std::vector<double> y = model.reference_state().y;
  std::vector<double> tau(6, 10.0), scratch(load->scratch());
  const std::vector<double> alone = slew_efforts(model, *load, 0.4);
  const std::size_t before = allocations();
  load->add(0.4, std::span(y).first(6), std::span(y).subspan(6, 6), tau, scratch);
  EXPECT_EQ(allocations(), before);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(tau[i], 10 + alone[i], 1e-14);
}

TEST(RigidInverseDynamics, conforms) {
  test::expect_load_conforms(*slew(1), two_link_arm(2));
  test::expect_load_conforms(*slew(0.2), two_link_arm(0));
}

TEST(RigidInverseDynamics, hinges_it_cannot_move_are_named) {
  Registry registry = load_registry();
  const Model model = two_link_arm(0);
  const auto text = [&](const std::string& hinge) -> std::string {
    const Value target = Value::map({{"from", Value(0.0)}, {"to", Value(1.0)}});
    const auto load = make_plugin<Load>(registry, "rigid-inverse-dynamics",
                                        {{"duration", Value(1.0)}, {"hinges", Value::map({{hinge, target}})}});
    try {
      (void)load->bind(model);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(text("wrist"), "there is no hinge 'wrist'");
  EXPECT_EQ(text("tip1"), "hinge 'tip1' has 0 rates; a trajectory moves hinges with one coordinate");
  Diagnostics diagnostics;
  EXPECT_EQ(make_plugin<Load>(registry, "rigid-inverse-dynamics",
                              {{"duration", Value(1.0)}, {"hinges", Value::map({})}}, diagnostics),
            nullptr);
  EXPECT_EQ(diagnostics.errors().size(), 1u);
}

}  // namespace
}  // namespace withy
