/// \file
/// Modes, steady states and branches of systems whose answer is known.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "blade.hpp"
#include "withy/core/analysis/mode_branches.hpp"

namespace withy::test {
namespace {

std::string scene_file(const std::string& name) {
  std::ifstream file(std::string(WITHY_SOURCES) + "/scenes/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// [PvF 5.1]: 3 and 4 rad/s; 3.010 and 4.059 with four modes a link, computed by an independent implementation.
TEST(LockedArm, has_the_published_frequencies) {
  const std::vector<std::string> four = {"bodies.link1.bending_y.modes=4", "bodies.link2.bending_y.modes=4"};
  for (const auto& [elbow, expected] : std::vector<std::pair<double, double>>{{0, 3.010}, {135, 4.059}}) {
    AnalysedScene c(scene_file("two-link-slew.yaml"), "quadratic", four);
    const Slot& slot = *c.layout().hinge("elbow");
    c.state.y[slot.position] = elbow * std::numbers::pi / 180;
    // The slew's efforts act on the hinges alone, which are held.
    const std::vector<Mode> modes = steady_modes(c, {"shoulder", "elbow"});
    EXPECT_NEAR(modes[0].frequency(), expected, 0.5e-3);
    EXPECT_GT(modes[0].damping_ratio(), 0);
  }
}

/// A free arm at rest has one rigid motion for each free hinge, and says so.
TEST(FreeArm, has_a_rigid_mode_for_each_free_hinge) {
  for (const std::string& formulation : all_formulations) {
    AnalysedScene c(scene_file("two-link-slew.yaml"), formulation);
    c.state.time = 100;  // the slew is over
    const std::vector<Mode> modes = steady_modes(c, {});
    ASSERT_EQ(modes.size(), 6U);
    int rigid = 0;
    for (const Mode& m : modes) rigid += m.rigid;
    EXPECT_EQ(rigid, 2) << formulation;
  }
}

/// Torque-free symmetric top of moments A = B, C spinning at Ω about its axis: nutation at Ω C/A in the inertial frame.
TEST(Top, nutates) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
bodies: {top: {type: rigid, mass: 1, inertia: [2, 2, 3, 0, 0, 0]}}
hinges: {ball: {type: spherical, parent: world, child: top}}
)",
                  "quadratic");
  c.state.y[c.layout().positions + 2] = 5.0;
  const std::vector<Mode> modes = steady_modes(c, {});
  ASSERT_EQ(modes.size(), 3U);
  EXPECT_NEAR(modes.back().frequency(), 5.0 * 3 / 2, 1e-9);
}

/// A disk of moment J on an axis that a spring k holds and a damper c brakes: ω² = k/J, ζ = c/(2√(kJ)).
TEST(DampedDisk, has_the_closed_form_frequency_and_damping) {
  const std::string text = R"(format: withy/1
time: {end: 1}
bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}
loads: {spring: {type: hinge-spring, hinge: axle, stiffness: 8, damping: CCC, free_position: 0.5}}
)";
  const auto with = [&](const std::string& damping) {
    std::string s = text;
    return s.replace(s.find("CCC"), 3, damping);
  };
  AnalysedScene under(with("0.8"), "quadratic");
  const Mode m = steady_modes(under, {})[0];
  EXPECT_NEAR(m.frequency(), 2, 1e-12);
  EXPECT_NEAR(m.damping_ratio(), 0.1, 1e-12);
  EXPECT_NEAR(under.state.y[0], 0.5, 1e-14) << "where the spring is slack";
  AnalysedScene over(with("20"), "quadratic");
  const Mode slow = steady_modes(over, {})[0];
  EXPECT_NEAR(slow.eigenvalue.real(), -5 + std::sqrt(21.0), 1e-12);
  EXPECT_NEAR(slow.partner.real(), -5 - std::sqrt(21.0), 1e-12);
}

/// Three disks on a shaft that nothing holds. Its momentum stays zero as it vibrates, and with it the share of the
/// first angle, by which all turn, although that angle moves most: of itself it would have two thirds.
TEST(FreeShaft, names_vibrations_after_what_stores_their_energy) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
bodies:
  a: {type: rigid, mass: 1, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
  b: {type: rigid, mass: 1, inertia: [0.01, 0.01, 0.01, 0, 0, 0]}
  c: {type: rigid, mass: 1, inertia: [10, 10, 10, 0, 0, 0]}
hinges:
  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  first: {type: revolute, axis: [0, 0, 1], parent: a, child: b}
  second: {type: revolute, axis: [0, 0, 1], parent: b, child: c}
loads:
  one: {type: hinge-spring, hinge: first, stiffness: 10}
  two: {type: hinge-spring, hinge: second, stiffness: 10}
)",
                  "quadratic");
  const std::vector<Mode> modes = steady_modes(c, {});
  ASSERT_EQ(modes.size(), 3U);
  const Mode& slow = modes[1];
  // λ² of J₁ θ̈₁ = k φ₁, J₂ θ̈₂ = k (φ₂ − φ₁), J₃ θ̈₃ = −k φ₂ with φ₁ = θ₂ − θ₁, φ₂ = θ₃ − θ₂.
  const double x = slow.frequency() * slow.frequency() / 1000;
  EXPECT_NEAR(x * x - 3.001 * x + 1.002, 0, 1e-9);
  EXPECT_NEAR(slow.shares[c.speed("axle")], 0, 1e-9);
  EXPECT_NEAR(slow.shares.sum(), 1, 1e-12);
  const std::array<double, 3> inertia = {0.01, 0.01, 10};
  double theta = 0, kinetic = 0, of_second = 0;
  for (int i = 0; i < 3; ++i) {
    theta += slow.shape[i].real();
    kinetic += inertia[static_cast<std::size_t>(i)] * theta * theta;
    if (i == 2) of_second = inertia[2] * theta * slow.shape[2].real();
  }
  EXPECT_NEAR(slow.shares[c.speed("second")], of_second / kinetic, 1e-9);
  EXPECT_EQ(slow.dominant, c.speed("second"));
}

/// A disk that is braked and not held stays anywhere and comes to rest, λ = 0 and −c/J: two motions, of which only one
/// has a damping ratio.
TEST(DampedDisk, that_nothing_holds_stays_anywhere_and_comes_to_rest) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
bodies: {disk: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: disk}}
loads: {brake: {type: hinge-spring, hinge: axle, stiffness: 0, damping: 4}}
)",
                  "quadratic");
  const std::vector<Mode> modes = steady_modes(c, {});
  ASSERT_EQ(modes.size(), 2U);
  EXPECT_TRUE(modes[0].rigid);
  EXPECT_TRUE(modes[0].single);
  EXPECT_EQ(modes[0].eigenvalue, 0.0);
  EXPECT_FALSE(modes[1].rigid);
  EXPECT_TRUE(modes[1].single);
  EXPECT_NEAR(modes[1].eigenvalue.real(), -2, 1e-12);
  EXPECT_NEAR(modes[1].damping_ratio(), 1, 1e-12);
}

/// A hub of 50 kg m² on an axle, with a beam whose fastest mode has 80,000 rad/s.
std::string hub_with_beam(const std::string& loads, const std::string& damping = "0") {
  return "format: withy/1\ntime: {end: 1}\nbodies:\n"
         "  hub: {type: rigid, mass: 100, inertia: [50, 50, 50, 0, 0, 0]}\n"
         "  b: {type: beam, length: 0.5, mass_per_length: 1, damping_ratio: " +
         damping +
         ", extension: {stiffness: 2.6e7, modes: 3},\n"
         "    bending_y: {stiffness: 200, modes: 3, family: orthogonal-polynomials}}\n"
         "hinges:\n  axle: {type: revolute, axis: [0, 0, 1], parent: world, child: hub}\n"
         "  root: {type: weld, parent: hub, child: b}\nloads: {" +
         loads + "}\n";
}
constexpr double hub_inertia = 50 + 0.5 * 0.25 / 3;  ///< [kg m²] with the beam

/// ω² = k/J and ζ = c/(2√(kJ)) hold as if the beam were rigid, to (ω/ω₁)² < 1e-7 of its mass.
TEST(Modes, that_are_slow_are_found_beside_those_that_are_millions_of_times_faster) {
  for (const double k : {5.0, 5e-2, 5e-4, 5e-6}) {
    const double omega = std::sqrt(k / hub_inertia), c = 2e-3 * std::sqrt(k * hub_inertia);
    for (const bool damped : {false, true}) {
      std::ostringstream spring;
      spring << "spring: {type: hinge-spring, hinge: axle, stiffness: " << k << ", damping: " << (damped ? c : 0)
             << "}";
      AnalysedScene scene(hub_with_beam(spring.str(), damped ? "0.01" : "0"), "quadratic");
      const std::vector<Mode> modes = steady_modes(scene, {});
      ASSERT_EQ(modes.size(), 7U) << k;
      EXPECT_FALSE(modes[0].rigid) << k;
      EXPECT_NEAR(modes[0].frequency(), omega, 1e-7 * omega) << k;
      EXPECT_NEAR(modes[0].damping_ratio(), damped ? 1e-3 : 0, 1e-8) << k;
      EXPECT_EQ(modes[0].dominant, scene.speed("axle"));
      EXPECT_GT(modes.back().frequency(), 8e4);
    }
  }
}

/// The same of a brake: the pole at −c/J is no zero, however slow.
TEST(Modes, of_what_a_weak_brake_stops_are_no_zeros_beside_fast_ones) {
  AnalysedScene scene(hub_with_beam("brake: {type: hinge-spring, hinge: axle, stiffness: 0, damping: 5e-4}"),
                      "quadratic");
  const std::vector<Mode> modes = steady_modes(scene, {});
  ASSERT_EQ(modes.size(), 8U);
  EXPECT_TRUE(modes[0].rigid && modes[0].single);
  EXPECT_TRUE(!modes[1].rigid && modes[1].single);
  EXPECT_NEAR(modes[1].eigenvalue.real(), -5e-4 / hub_inertia, 1e-7 * 5e-4 / hub_inertia);
  EXPECT_EQ(modes[1].dominant, scene.speed("axle"));
}

TEST(Modes, of_what_nothing_holds_are_rigid_beside_fast_ones) {
  AnalysedScene scene(hub_with_beam(""), "quadratic");
  const std::vector<Mode> modes = steady_modes(scene, {});
  ASSERT_EQ(modes.size(), 7U);
  EXPECT_TRUE(modes[0].rigid && !modes[0].single);
  EXPECT_EQ(modes[0].dominant, scene.speed("axle"));
  for (std::size_t i = 1; i < modes.size(); ++i) EXPECT_FALSE(modes[i].rigid) << i;
}

/// A tether of 1e5 N, whose stretching is a million times faster than its bending.
TEST(Modes, of_a_soft_and_inextensible_beam_are_not_rigid) {
  AnalysedScene scene(R"(format: withy/1
time: {end: 1}
bodies:
  b: {type: beam, length: 100, mass_per_length: 0.01, bending_y: {stiffness: 1e-3, modes: 3},
      extension: {stiffness: 1e5, modes: 2}}
hinges: {root: {type: weld, parent: world, child: b}}
)",
                      "quadratic");
  const std::vector<Mode> modes = steady_modes(scene, {});
  ASSERT_EQ(modes.size(), 5U);
  EXPECT_FALSE(modes[0].rigid);
  // (β₁L)² √(EI/ρ)/L²
  EXPECT_NEAR(modes[0].frequency(), 3.5160152685 * std::sqrt(0.1) / 1e4, 1e-12);
}

/// The more segments, the faster the fastest mode: the slowest one and the number of all stay what they are.
TEST(Modes, of_a_beam_in_many_segments_are_all_there) {
  const auto modes_of = [](int segments) {
    AnalysedScene scene(
        "format: withy/1\ntime: {end: 1}\nbodies:\n"
        "  b: {type: beam, length: 2, mass_per_length: 1.5, damping_ratio: 0.01, segments: " +
            std::to_string(segments) +
            ",\n    bending_y: {stiffness: 40, modes: 3, family: orthogonal-polynomials}}\n"
            "hinges: {root: {type: weld, parent: world, child: b}}\n",
        "quadratic");
    const std::vector<Mode> modes = steady_modes(scene, {});
    EXPECT_EQ(modes.size(), 3U * static_cast<std::size_t>(segments));
    for (const Mode& mode : modes) EXPECT_FALSE(mode.rigid || mode.single);
    return modes;
  };
  const double slowest = 3.5160152685 * std::sqrt(40 / 1.5) / 4;
  for (const int segments : {4, 32})
    EXPECT_NEAR(modes_of(segments)[0].frequency(), slowest, 1e-6 * slowest) << segments;
}

/// 0.02 rad, whatever the beam's stiffness: a spring that is soft beside it is a spring.
TEST(SteadyState, of_a_soft_spring_is_found_beside_stiff_bodies) {
  for (const double k : {5.0, 5e-2, 5e-4, 5e-6}) {
    std::ostringstream loads;
    loads << "spring: {type: hinge-spring, hinge: axle, stiffness: " << k << "}, "
          << "push: {type: hinge-effort, hinge: axle, law: constant, value: " << 0.02 * k << "}";
    AnalysedScene scene(hub_with_beam(loads.str()), "quadratic");
    const SteadyState steady = find_steady_state(*scene.dynamics, scene.state, Held(scene.layout().speeds, false));
    ASSERT_TRUE(steady.converged) << k;
    EXPECT_EQ(steady.neutral.size(), 0) << k;
    EXPECT_NEAR(steady.state.y[scene.layout().hinge("axle")->position], 0.02, 1e-12) << k;
  }
}

/// Tip load P = m g on a light cantilever, P L²/EI = 1 and 2: the elastica's tip is 0.30172 L, 0.49346 L lower and
/// 0.05643 L, 0.16064 L nearer (Bisshopp & Drucker, Quart. Appl. Math. 3, 1945).
TEST(SteadyState, of_exact_kinematics_is_the_elastica) {
  for (const auto& [load, down, in] :
       std::vector<std::tuple<double, double, double>>{{1, 0.30172, 0.05643}, {2, 0.49346, 0.16064}}) {
    std::ostringstream text;
    text << "format: withy/1\ntime: {end: 1}\ngravity: [0, " << -load
         << ", 0]\nbodies:\n  arm: {type: beam, length: 1, "
         << "mass_per_length: 1e-9, bending_y: {stiffness: 1, modes: 8}}\n  weight: {type: rigid, mass: 1}\n"
         << "hinges:\n  wall: {type: weld, parent: world, child: arm}\n"
         << "  end: {type: weld, parent: arm.tip, child: weight}\n";
    AnalysedScene c(text.str(), "exact");
    const SteadyState steady = find_steady_state(*c.dynamics, c.state, Held(c.layout().speeds, false));
    ASSERT_TRUE(steady.converged);
    EXPECT_LE(steady.iterations, 12);
    const auto tip =
        c.equations->deflection(steady.state.y, c.scene.model->body("arm"), c.scene.model->bodies()[0].frame("tip"));
    // Eight clamped-free modes leave 1e-4 of the length: the moment's slope at the tip is none of theirs.
    EXPECT_NEAR(tip[1], -down, 1e-4);
    EXPECT_NEAR(tip[0], -in, 1e-4);
  }
}

/// A steady state has no accelerations, whatever the sweeps are asked.
TEST(SteadyState, has_no_accelerations) {
  for (const std::string& formulation : all_formulations) {
    AnalysedScene c(scene_file("two-link-slew.yaml"), formulation, {"gravity.1=-2"});
    c.state.time = 100;
    c.state.y[c.layout().hinge("shoulder")->position] = -1.2;
    c.state.y[c.layout().hinge("elbow")->position] = 0.3;
    const SteadyState steady = find_steady_state(*c.dynamics, c.state, Held(c.layout().speeds, false));
    ASSERT_TRUE(steady.converged) << formulation;
    std::vector<double> rates(c.equations->size());
    Work work = c.equations->make_work();
    ASSERT_TRUE(c.equations->derivatives(100, steady.state.y, rates, work).ok());
    // Rounding, times a condition of M of up to 1e6.
    for (const double r : rates) EXPECT_NEAR(r, 0, 1e-7) << formulation;
  }
}

/// Nothing holds a body that falls; the direction is named.
TEST(SteadyState, of_a_falling_body_is_not_found) {
  AnalysedScene c(R"(format: withy/1
time: {end: 1}
gravity: [0, 0, -9.81]
bodies: {stone: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {drop: {type: prismatic, axis: [0, 0, 1], parent: world, child: stone}}
)",
                  "quadratic");
  const SteadyState steady = find_steady_state(*c.dynamics, c.state, Held(1, false));
  EXPECT_FALSE(steady.converged);
  ASSERT_EQ(steady.neutral.size(), 1);
  EXPECT_NEAR(std::abs(steady.neutral[0]), 1, 1e-12);
  EXPECT_NEAR(steady.efforts[0], 9.81, 1e-12) << "what would hold it";
}

/// A spinning blade under gravity across its plane droops as K q = load says at first order, and flap stiffens it.
TEST(SteadyState, of_a_spinning_blade_droops_less) {
  double droop[2];
  for (const int fast : {0, 1}) {
    AnalysedScene c(blade(2, 4, "", "", "[0, 0, -0.1]"), "exact");
    c.spin("axle", 6.0 * fast);
    const Held held = hold(c, {"axle"});
    const SteadyState steady = find_steady_state(*c.dynamics, c.state, held);
    ASSERT_TRUE(steady.converged);
    const Tangents t = c.dynamics->tangents(0, steady.state.y, Eigen::VectorXd::Zero(c.speeds()));
    EXPECT_TRUE(stays_steady(*c.dynamics, t, steady.state, held));
    droop[fast] = -c.equations->deflection(steady.state.y, 0, c.scene.model->bodies()[0].frame("tip"))[2];
  }
  EXPECT_NEAR(droop[0], 0.1 / 8, 1e-4) << "ρ g L⁴ / 8 EI";
  EXPECT_LT(droop[1], 0.5 * droop[0]);
  AnalysedScene vertical(blade(2, 2, "", "", "[0, -0.1, 0]"), "exact");
  vertical.spin("axle", 6);
  const Held held = hold(vertical, {"axle"});
  EXPECT_FALSE(stays_steady(*vertical.dynamics, steady_tangents(vertical, held), vertical.state, held))
      << "gravity turns in the rotating frame";
}

/// Motion from a state displaced along a mode's shape is that mode: after five and a quarter periods the coordinate
/// that moves most passes zero. Fourth-order Runge–Kutta with 8000 steps a period leaves (2π/8000)⁴·5; the amplitude
/// 1e-6, whose square is the formulations' nonlinearity.
TEST(Modes, are_what_a_simulation_shows) {
  for (const std::string formulation : {"quadratic", "consistent", "exact"}) {
    AnalysedScene c(scene_file("two-link-slew.yaml"), formulation,
                    {"gravity.1=-2", "bodies.link1.damping_ratio=0", "bodies.link2.damping_ratio=0"});
    c.state.time = 100;
    c.state.y[c.layout().hinge("shoulder")->position] = -1.5;
    c.state.y[c.layout().hinge("elbow")->position] = 0.05;
    std::vector<Mode> modes = steady_modes(c, {});
    std::sort(modes.begin(), modes.end(),
              [](const Mode& a, const Mode& b) { return a.squared_frequency() < b.squared_frequency(); });
    const Mode& mode = modes[2];
    ASSERT_FALSE(mode.rigid);
    std::vector<double> y = c.state.y;
    const double amplitude = 1e-6;
    Eigen::VectorXd shape = mode.shape.real();
    Eigen::Index most = 0;
    shape.cwiseAbs().maxCoeff(&most);
    shape /= double(shape[most]);
    c.dynamics->displace(y, amplitude * shape);
    const double period = 2 * std::numbers::pi / mode.frequency();
    const int steps = 42000;
    const double h = 5.25 * period / steps;
    Work work = c.equations->make_work();
    const std::size_t n = y.size();
    std::vector<double> k(n), sum(n), at(n);
    for (int i = 0; i < steps; ++i) {
      at = y;
      sum.assign(n, 0);
      for (const auto& [weight, next] : std::vector<std::pair<double, double>>{{1, 0.5}, {2, 0.5}, {2, 1}, {1, 0}}) {
        ASSERT_TRUE(c.equations->derivatives(100, at, k, work).ok());
        for (std::size_t j = 0; j < n; ++j) {
          sum[j] += weight / 6 * k[j];
          at[j] = y[j] + next * h * k[j];
        }
      }
      for (std::size_t j = 0; j < n; ++j) y[j] += h * sum[j];
    }
    const double rate = y[c.layout().positions + static_cast<std::size_t>(most)];
    EXPECT_NEAR(rate, -amplitude * mode.frequency(), 1e-3 * amplitude * mode.frequency()) << formulation;
    for (std::size_t i = 0; i < c.layout().speeds; ++i)
      EXPECT_NEAR(y[i], c.state.y[i], 1e-3 * amplitude) << formulation << " " << c.layout().speed_names[i];
  }
}

/// Flap and lag cross as the stiffness of one is swept; each branch keeps its direction.
TEST(Branches, keep_their_shape_where_they_cross) {
  BranchTracker tracker;
  for (int k = 0; k <= 20; ++k) {
    AnalysedScene c(blade(1, 1), "quadratic", {"bodies.blade.bending_z.stiffness=" + std::to_string(0.505 + 0.05 * k)});
    const Held held = hold(c, {"axle"});
    const Tangents t = c.dynamics->tangents(0, c.state.y, Eigen::VectorXd::Zero(c.speeds()));
    const auto modes = tracker.follow(natural_modes(t, held), t.mass.diagonal()).modes;
    EXPECT_EQ(c.layout().speed_names[static_cast<std::size_t>(modes[0].dominant)], "blade.bending_z[1]") << k;
    EXPECT_NEAR(modes[1].frequency(), 3.5160152685, 1e-7);
  }
}

/// A pole of a filter passes a vibration of the same modulus; both move the one coordinate there is.
TEST(Branches, of_loops_keep_poles_apart_that_have_one_modulus) {
  const auto mode = [](std::complex<double> eigenvalue) {
    Mode m;
    m.eigenvalue = eigenvalue;
    m.single = eigenvalue.imag() == 0;
    m.partner = std::conj(eigenvalue);
    m.shape = Eigen::VectorXcd::Ones(1);
    return m;
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  BranchTracker tracker;
  static_cast<void>(tracker.follow({mode(-9), mode({-1, 10})}, one, Closeness::of_eigenvalues));
  const BranchedModes next = tracker.follow({mode(-10.05), mode({-1.2, 10.2})}, one, Closeness::of_eigenvalues);
  EXPECT_EQ(next.modes[0].eigenvalue, -10.05);
  EXPECT_EQ(next.modes[1].eigenvalue, std::complex<double>(-1.2, 10.2));
  // A pair becomes two real ones, of which one goes on; then they are one again.
  const BranchedModes parted = tracker.follow({mode(-10.2), mode(-7), mode(-8)}, one, Closeness::of_eigenvalues);
  EXPECT_EQ(parted.branches, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(parted.modes[0].eigenvalue, -10.2);
  const BranchedModes met = tracker.follow({mode(-10.3), mode({-7.5, 0.1})}, one, Closeness::of_eigenvalues);
  ASSERT_EQ(met.modes.size(), 2U);
  EXPECT_EQ(met.branches[0], 0U);
  EXPECT_GT(met.branches[1], 0U);
}

}  // namespace
}  // namespace withy::test
