/// \file
/// Periodic linear systems: Floquet's theory and the multi-blade transform, against tables, each other and simulation.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "blade.hpp"
#include "rotor.hpp"
#include "withy/core/analysis/multiblade.hpp"

namespace withy::test {
namespace {

constexpr double twelve_rpm = 0.4 * std::numbers::pi;

/// ẍ + 2cẋ + (a − 2q cos 2t) x = 0.
PeriodicMatrix mathieu(double a, double q, double c = 0) {
  std::vector<Eigen::MatrixXd> samples;
  for (int k = 0; k < 5; ++k) {
    Eigen::MatrixXd A(2, 2);
    A << 0, 1, -(a - 2 * q * std::cos(2 * std::numbers::pi * k / 5)), -2 * c;
    samples.push_back(A);
  }
  return {samples, std::numbers::pi};
}

/// Characteristic values of Mathieu's equation (Abramowitz & Stegun, table 20.1), where a multiplier is +1 (a₀, a₂, b₂)
/// or −1 (a₁, b₁) and stability changes.
TEST(Mathieu, is_stable_between_the_tabulated_characteristic_values) {
  struct Boundary {
    double q, a;
    int multiplier;
    bool stable_above;
  };
  const std::vector<Boundary> table = {
      {1, -0.45513860, 1, true}, {1, -0.11024882, -1, false}, {1, 1.85910807, -1, true},   {1, 3.91702477, 1, false},
      {1, 4.37130098, 1, true},  {5, -5.80004602, 1, true},   {5, -5.79008060, -1, false}, {5, 1.85818754, -1, true},
      {5, 2.09946045, 1, false}, {5, 7.44910974, 1, true}};
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  for (const Boundary& b : table) {
    // The trace moves by some thousands for a step of one in a where q = 5 and a is least; the table has eight
    // decimals.
    const double trace = monodromy(mathieu(b.a, b.q), 512).trace();
    EXPECT_NEAR(trace, 2.0 * b.multiplier, 1e-5) << b.q << ' ' << b.a;
    EXPECT_EQ(floquet(mathieu(b.a + 1e-4, b.q), one).stable(), b.stable_above) << b.q << ' ' << b.a;
    EXPECT_EQ(floquet(mathieu(b.a - 1e-4, b.q), one).stable(), !b.stable_above) << b.q << ' ' << b.a;
  }
}

/// Damping c shifts the exponents of Mathieu's equation by −c if a is replaced by a + c².
TEST(Mathieu, damped_is_the_undamped_shifted) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const auto plain = floquet(mathieu(1.2, 0.8), one).modes, damped = floquet(mathieu(1.24, 0.8, 0.2), one).modes;
  ASSERT_EQ(plain.size(), damped.size());
  for (std::size_t i = 0; i < plain.size(); ++i)
    EXPECT_NEAR(damped[i].exponent.real(), plain[i].exponent.real() - 0.2, 1e-9);
}

/// Of a pair the one is told whose strongest harmonic goes round forwards, and its lines are of that one.
TEST(Mathieu, the_strongest_line_is_at_the_frequency_of_the_mode) {
  for (const double a : {0.5, 1.9, 2.6, 3.4, 5.0, 7.0}) {
    const FloquetAnalysis f = floquet(mathieu(a, 0.3), Eigen::VectorXd::Ones(1));
    for (const CharacteristicMode& mode : f.modes) {
      ASSERT_FALSE(mode.lines.empty());
      EXPECT_GT(mode.exponent.imag(), 0) << a;
      EXPECT_EQ(mode.lines.front().first, mode.exponent.imag()) << a;
    }
  }
}

/// In the principal instability the multiplier is real, and the motion e^{λt} (cos t + …): an instrument sees one line
/// at 1 rad/s, which harmonics at 1 and −1 make.
TEST(Mathieu, motions_of_a_real_multiplier_are_seen_once_at_each_frequency) {
  const FloquetAnalysis f = floquet(mathieu(1, 0.3), Eigen::VectorXd::Ones(1));
  ASSERT_EQ(f.modes.size(), 2U);
  for (const CharacteristicMode& mode : f.modes) {
    EXPECT_NEAR(mode.exponent.imag(), 1, 1e-9);
    EXPECT_GT(mode.share, 0.95);
    double all = 0;
    std::vector<double> seen;
    for (const auto& [frequency, share] : mode.lines) {
      for (const double other : seen) EXPECT_GT(std::abs(std::abs(frequency) - other), 1) << frequency;
      seen.push_back(std::abs(frequency));
      all += share;
    }
    EXPECT_LE(all, 1 + 1e-12);
    EXPECT_EQ(seen[0], mode.exponent.imag());
  }
}

/// Nothing turns with a period that is looked at all the same: the exponents are the eigenvalues, with the whole
/// frequency although the multiplier tells it by 2π/T alone.
TEST(Floquet, of_constant_coefficients_is_the_eigenvalue) {
  Eigen::MatrixXd A(4, 4);
  A << 0, 0, 1, 0, 0, 0, 0, 1, -9, 0, -0.2, 0, 0, -522.0 * 522, 0, -1;
  const FloquetAnalysis f = floquet(PeriodicMatrix(std::vector<Eigen::MatrixXd>(3, A), 5), Eigen::Vector2d(1, 2));
  ASSERT_EQ(f.modes.size(), 2U);
  EXPECT_NEAR(f.modes[0].exponent.real(), -0.1, 1e-9);
  EXPECT_NEAR(f.modes[0].exponent.imag(), std::sqrt(9 - 0.01), 1e-9);
  EXPECT_NEAR(f.modes[1].exponent.real(), -0.5, 1e-7);
  EXPECT_NEAR(f.modes[1].exponent.imag(), std::sqrt(522.0 * 522 - 0.25), 1e-6);
  EXPECT_EQ(f.modes[1].dominant, 1);
  EXPECT_NEAR(f.modes[0].share, 1, 1e-12);
}

/// Mathieu's equation beside two vibrations of these frequencies [rad/s], in coordinates that mix the three; what
/// varies couples all of them.
PeriodicMatrix mathieu_beside(double a, double q, double second, double third) {
  Eigen::Matrix3d mix;
  mix << 1, 0.5, -0.25, -0.5, 1, 0.125, 0.25, 0.375, 1;
  const Eigen::Matrix3d back = mix.inverse();
  const Eigen::Vector3d shares(1, 100, 110);
  std::vector<Eigen::MatrixXd> samples;
  for (int k = 0; k < 5; ++k) {
    Eigen::Matrix3d stiffness = Eigen::Vector3d(a, second * second, third * third).asDiagonal();
    stiffness -= 2 * q * std::cos(2 * std::numbers::pi * k / 5) * shares * shares.transpose();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
    A.topRightCorner(3, 3).setIdentity();
    A.bottomLeftCorner(3, 3) = -mix * stiffness * back;
    samples.push_back(A);
  }
  return {samples, std::numbers::pi};
}

/// Ten thousand vibrations within the period, on which steps were thrown that are right for constant coefficients
/// alone: they were said to be unstable, with a growth of nan.
TEST(Floquet, follows_vibrations_that_are_fast_beside_what_turns) {
  const double a = 2.5, q = 0.8;
  const CharacteristicMode slow = floquet(mathieu(a, q), Eigen::VectorXd::Ones(1)).modes[0];
  for (const double fast : {2000.3, 20000.3}) {
    const FloquetAnalysis f = floquet(mathieu_beside(a, q, fast, 1.1 * fast), Eigen::Vector3d::Ones());
    ASSERT_EQ(f.modes.size(), 3U);
    EXPECT_TRUE(f.stable()) << fast;
    // What they do to the slow motion while it pushes them: (160/fast)² of its stiffness.
    EXPECT_NEAR(f.modes[0].exponent.imag(), slow.exponent.imag(), std::pow(160 / fast, 2)) << fast;
    // But for multiples of the turn's rate, by which they are modulated; and for what they do to each other.
    const double together = std::pow(1.76e4 / (2 * fast), 2) / (0.1 * fast);
    EXPECT_NEAR(std::remainder(f.modes[1].exponent.imag() - fast, 2), 0, together) << fast;
    EXPECT_NEAR(std::remainder(f.modes[2].exponent.imag() - 1.1 * fast, 2), 0, together) << fast;
    EXPECT_NEAR(f.modes[1].exponent.imag(), fast, 4) << fast;
  }
}

/// Where they are too fast for any number of steps that is to be waited for, that is said.
TEST(Floquet, says_where_vibrations_are_too_fast) {
  try {
    (void)floquet(mathieu_beside(1.2, 0.8, 1e7, 1.1e7), Eigen::Vector3d::Ones());
    ADD_FAILURE() << "followed";
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("take fewer modes"), std::string::npos) << e.what();
  }
}

struct Turbine {
  AnalysedScene scene;
  Held held;
  State steady;
  Turbine(int blades, const std::string& gravity, double angle = 0, std::vector<std::string> overrides = {})
      : scene(rotor(blades, "", gravity), "quadratic", std::move(overrides)), held(hold(scene, {"shaft"})) {
    scene.spin("shaft", twelve_rpm);
    scene.state.y[scene.layout().hinge("shaft")->position] = angle;
    const SteadyState s = find_steady_state(*scene.dynamics, scene.state, held);
    EXPECT_TRUE(s.converged);
    steady = s.state;
  }
  [[nodiscard]] TurnCheck check() const { return check_turn(*scene.dynamics, steady, held); }
  [[nodiscard]] TurningForm form() const {
    return turning_form(*scene.dynamics, steady, held, turning(*scene.scene.model, steady));
  }
};

/// Two blades on one side of the shaft: at 90° the frozen equations grow at 0.03/s, at 0° they decay; over a turn they
/// decay at 0.0077/s, wherever one begins (an independent computation gave −0.0077).
TEST(TwoBlades, are_stable_although_a_frozen_angle_grows) {
  const std::vector<std::string> one_side = {
      "bodies.hub.frames.b2.orientation=[0, 0.7071067811865476, 0, 0.7071067811865476]"};
  const Turbine up(2, "[0, 0, 0]", 0, one_side), across(2, "[0, 0, 0]", std::numbers::pi / 2, one_side);
  const auto frozen = [](const Turbine& t) {
    const Tangents at = t.scene.dynamics->tangents(0, t.steady.y, Eigen::VectorXd::Zero(t.scene.speeds()));
    double growth = -1;
    for (const Mode& m : natural_modes(at, t.held)) growth = std::max(growth, m.growth());
    return growth;
  };
  EXPECT_LT(frozen(up), -0.007);
  EXPECT_NEAR(frozen(across), 0.031, 0.001);
  EXPECT_FALSE(up.check().steady);
  EXPECT_TRUE(up.check().periodic());
  const TurningForm form = up.form();
  const FloquetAnalysis f = floquet(form.A, form.masses), again = [&] {
    const TurningForm other = across.form();
    return floquet(other.A, other.masses);
  }();
  EXPECT_TRUE(f.stable());
  EXPECT_NEAR(f.modes[0].exponent.real(), -0.0077, 0.5e-4);
  ASSERT_EQ(f.modes.size(), again.modes.size());
  for (std::size_t i = 0; i < f.modes.size(); ++i)
    EXPECT_LT(std::abs(f.modes[i].exponent - again.modes[i].exponent), 1e-7) << i;
}

/// The monodromy matrix is what the equations of motion do with small displacements in a turn, integrated by an
/// algorithm that knows nothing of it.
TEST(TwoBlades, monodromy_is_what_a_simulation_shows) {
  AnalysedScene c(rotor(2, "motions: {spin: {type: constant-rate, hinge: shaft, rate: 1.2566370614359172}}\n"),
                  "quadratic");
  c.scene.model->prescribe(c.state);
  const Held held = hold(c, {"shaft"});
  const Turning turned = turning(*c.scene.model, c.state);
  ASSERT_NEAR(turned.period, 5, 1e-12);
  const TurningForm form = turning_form(*c.dynamics, c.state, held, turned);
  const Eigen::MatrixXd whole = monodromy(form.A, 2048);
  const std::vector<double>& begin = form.turn.states[0].y;
  const auto after_a_turn = [&](std::vector<double> y) {
    // Fourth order: 6000 steps of h ω = 0.025 leave 3e-8 of the fastest mode.
    const int steps = 6000;
    const double h = 5.0 / steps;
    const std::size_t n = y.size();
    Work work = c.equations->make_work();
    std::vector<double> k(n), sum(n), at(n);
    for (int i = 0; i < steps; ++i) {
      at = y, sum.assign(n, 0);
      const double weights[] = {1, 2, 2, 1}, nexts[] = {0.5, 0.5, 1, 0}, times[] = {0, 0.5, 0.5, 1};
      for (int s = 0; s < 4; ++s) {
        EXPECT_TRUE(c.equations->derivatives((i + times[s]) * h, at, k, work).ok());
        for (std::size_t j = 0; j < n; ++j) {
          sum[j] += weights[s] / 6 * k[j];
          at[j] = y[j] + nexts[s] * h * k[j];
        }
      }
      for (std::size_t j = 0; j < n; ++j) y[j] += h * sum[j];
    }
    return y;
  };
  const std::vector<Eigen::Index> free = free_speeds(held);
  const auto m = static_cast<Eigen::Index>(free.size());
  const double amplitude = 1e-4;
  for (const std::string name : {"tower.bending_y[1]", "blade1.bending_z[1]"}) {
    Eigen::Index column = 0;
    while (c.layout().speed_names[static_cast<std::size_t>(free[static_cast<std::size_t>(column)])] != name) ++column;
    std::vector<double> plus = begin, minus = begin;
    c.dynamics->displace(plus, amplitude * Eigen::VectorXd::Unit(c.speeds(), free[static_cast<std::size_t>(column)]));
    c.dynamics->displace(minus, -amplitude * Eigen::VectorXd::Unit(c.speeds(), free[static_cast<std::size_t>(column)]));
    plus = after_a_turn(plus), minus = after_a_turn(minus);
    for (Eigen::Index i = 0; i < m; ++i) {
      const std::size_t speed = c.layout().positions + static_cast<std::size_t>(free[static_cast<std::size_t>(i)]);
      const double moved = (plus[speed] - minus[speed]) / (2 * amplitude);
      EXPECT_NEAR(moved, whole(m + i, column), 1e-5 * whole.col(column).cwiseAbs().maxCoeff()) << name << ' ' << i;
    }
  }
}

/// That what does not turn sees Floquet's exponents [1/s], the frequencies but for whole turns.
void expect_same_exponents(const std::vector<CharacteristicMode>& modes, const FloquetAnalysis& whole,
                           double tolerance) {
  ASSERT_EQ(modes.size(), whole.modes.size());
  for (const CharacteristicMode& mode : modes) {
    double nearest = 1;
    for (const CharacteristicMode& other : whole.modes) {
      const double turns = (mode.exponent.imag() - other.exponent.imag()) / twelve_rpm;
      nearest = std::min(
          nearest, std::hypot(mode.exponent.real() - other.exponent.real(), twelve_rpm * (turns - std::round(turns))));
    }
    EXPECT_LT(nearest, tolerance) << mode.exponent;
  }
}

/// Three equal blades: the transform makes the equations constant, and their eigenvalues are Floquet's exponents, the
/// frequencies but for whole turns. At a frozen angle they are not: 0.15 % of the tower's.
TEST(ThreeBlades, coleman_is_floquet) {
  const Turbine t(3, "[0, 0, 0]");
  const TurnCheck check = t.check();
  EXPECT_TRUE(check.periodic());
  EXPECT_TRUE(check.steady);
  EXPECT_GT(check.change, 0.2);
  const TurningForm form = t.form();
  EXPECT_TRUE(form.turn.constant);
  const auto branches = equal_branches(*t.scene.scene.model, {});
  ASSERT_EQ(branches.size(), 1U);
  const MultibladeForm seen = multiblade_form(form, t.held, t.scene.layout().speed_names, {}, branches[0]);
  EXPECT_LT(seen.A.change(), 1e-12);
  const auto modes = constant_modes(seen.A.mean(), seen.masses);
  const FloquetAnalysis f = floquet(form.A, form.masses);
  expect_same_exponents(modes, f, 1e-8);
  EXPECT_EQ(pattern(seen, modes[2]), "blade1.bending_z[1] backward");
  EXPECT_EQ(pattern(seen, modes[3]), "blade1.bending_z[1] collective");
  // In the rotor the two whirling modes are one turn nearer to each other.
  EXPECT_NEAR(modes[5].exponent.imag() - modes[2].exponent.imag(), 2 * twelve_rpm, 0.02);
  EXPECT_EQ(pattern(seen, modes[5]), "blade1.bending_z[1] forward");
}

/// A yaw drive with an integral and a filter turns with no blade: the transform leaves its states as they are, and the
/// eigenvalues are Floquet's exponents again, those of the drive among them.
TEST(ThreeBlades, with_a_yaw_drive_coleman_is_floquet) {
  std::string text = rotor(3, R"(loads:
  drive: {type: pid, hinge: yaw, proportional: 4.0e+8, integral: 1.0e+8, derivative: 2.0e+8, filter: 0.2}
)");
  text.replace(text.find("yaw: {type: weld"), 16, "yaw: {type: revolute, axis: [0, 0, 1]");
  AnalysedScene c(text, "quadratic");
  const Held held = hold(c, {"shaft"});
  c.spin("shaft", twelve_rpm);
  const SteadyState steady = find_steady_state(*c.dynamics, c.state, held);
  ASSERT_TRUE(steady.converged);
  const TurnCheck check = check_turn(*c.dynamics, steady.state, held);
  EXPECT_TRUE(check.periodic());
  EXPECT_TRUE(check.steady);
  const TurningForm form = turning_form(*c.dynamics, steady.state, held, check.turning);
  ASSERT_EQ(form.A.rows(), 2 * form.masses.size() + 2);
  const MultibladeForm seen = multiblade_form(form, held, c.layout().speed_names, c.layout().continuous_names,
                                              equal_branches(*c.scene.model, {})[0]);
  EXPECT_LT(seen.A.change(), 1e-12);
  const auto modes = constant_modes(seen.A.mean(), seen.masses);
  const FloquetAnalysis f = floquet(form.A, form.masses);
  expect_same_exponents(modes, f, 1e-7);
  EXPECT_TRUE(std::any_of(modes.begin(), modes.end(),
                          [&](const CharacteristicMode& mode) { return pattern(seen, mode).starts_with("drive."); }));
}

/// Weight turns in the blades: the motion is periodic, the transform leaves 0.3 % of A changing, and the averaged
/// equations have Floquet's exponents to 1e-4.
TEST(ThreeBlades, under_weight_are_nearly_constant_to_the_transform) {
  const Turbine t(3, "[0, 0, -9.81]");
  EXPECT_FALSE(t.check().steady);
  const TurningForm form = t.form();
  EXPECT_FALSE(form.turn.constant);
  const MultibladeForm seen =
      multiblade_form(form, t.held, t.scene.layout().speed_names, {}, equal_branches(*t.scene.scene.model, {})[0]);
  EXPECT_GT(seen.A.change(), 1e-3);
  EXPECT_LT(seen.A.change(), 1e-2);
  const FloquetAnalysis f = floquet(form.A, form.masses);
  EXPECT_NEAR(constant_modes(seen.A.mean(), seen.masses)[0].exponent.real(), f.modes[0].exponent.real(), 1e-5);
}

/// More instants do not change the periodic motion.
TEST(Turn, is_found_between_its_instants_too) {
  const Turbine t(3, "[0, 0, -9.81]");
  const Turning turned = turning(*t.scene.scene.model, t.steady);
  const Turn coarse = find_turn(*t.scene.dynamics, t.steady, t.held, turned, 15),
             fine = find_turn(*t.scene.dynamics, t.steady, t.held, turned, 45);
  for (std::size_t k = 0; k < 15; ++k) {
    for (std::size_t i = 0; i < t.scene.layout().positions + t.scene.layout().speeds; ++i)
      EXPECT_NEAR(coarse.states[k].y[i], fine.states[3 * k].y[i], 1e-7) << k << ' ' << i;
  }
}

/// A blade that is heavier than the others is no blade of a rotor of equal ones; two are too few.
TEST(Multiblade, refuses_what_is_not_equal) {
  const Turbine two(2, "[0, 0, 0]");
  EXPECT_TRUE(equal_branches(*two.scene.scene.model, {}).empty());
  EXPECT_THROW((void)equal_branches(*two.scene.scene.model, {"blade1", "blade2"}), std::invalid_argument);
  EXPECT_THROW((void)equal_branches(*two.scene.scene.model, {"blade1", "blade2", "tower"}), std::invalid_argument);
  EXPECT_THROW((void)equal_branches(*two.scene.scene.model, {"blade1", "blade2", "blade9"}), std::invalid_argument);

  AnalysedScene c(rotor(3), "quadratic", {"bodies.hub.frames.b2.position.0=0.5"});
  const Held held = hold(c, {"shaft"});
  c.spin("shaft", twelve_rpm);
  const TurningForm form = turning_form(*c.dynamics, c.state, held, turning(*c.scene.model, c.state));
  const auto branches = equal_branches(*c.scene.model, {"root1", "root2", "root3"});
  EXPECT_THROW((void)multiblade_form(form, held, c.layout().speed_names, {}, branches[0]), std::domain_error);
}

/// Periods of several rates, and why there is none.
TEST(Turning, has_the_common_period) {
  const std::string two = R"(format: withy/1
time: {end: 1}
bodies:
  a: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0], center_of_mass: [0.1, 0, 0]}
  b: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0], center_of_mass: [0.1, 0, 0]}
hinges:
  first: {type: revolute, axis: [0, 0, 1], parent: world, child: a}
  second: {type: SECOND, axis: [1, 0, 0], parent: a, child: b}
)";
  const auto with = [&](const std::string& kind) {
    std::string s = two;
    return s.replace(s.find("SECOND"), 6, kind);
  };
  AnalysedScene c(with("revolute"), "quadratic");
  EXPECT_EQ(turning(*c.scene.model, c.state).period, 0) << "nothing moves";
  c.spin("first", 3), c.spin("second", -2);
  EXPECT_NEAR(turning(*c.scene.model, c.state).period, 2 * std::numbers::pi, 1e-12);
  // A period that is given is a multiple of that.
  EXPECT_EQ(turning(*c.scene.model, c.state, 4 * std::numbers::pi).period, 4 * std::numbers::pi);
  EXPECT_NE(turning(*c.scene.model, c.state, 3 * std::numbers::pi).problem.find("do not come back"), std::string::npos);
  c.spin("second", std::sqrt(2.0));
  EXPECT_NE(turning(*c.scene.model, c.state).problem.find("common period"), std::string::npos);
  AnalysedScene line(with("prismatic"), "quadratic");
  line.spin("second", 1);
  EXPECT_NE(turning(*line.scene.model, line.state).problem.find("does not come back"), std::string::npos);
}

/// A pendulum whose pivot shakes up and down at 2Ω is Mathieu's: with a = 4g/(l ω²), q = 2A/l in τ = ωt/2, upright at
/// −a. Shaken hard enough it stands (Kapitza): between q²/2 ≈ a and the boundary of b₁.
TEST(Pendulum, stands_on_a_shaking_pivot) {
  const auto exponents = [](double amplitude) {
    std::ostringstream text;
    text << R"(format: withy/1
time: {end: 1}
gravity: [0, 0, -9.81]
bodies:
  cart: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}
  rod: {type: rigid, mass: 1, center_of_mass: [0, 0, 0.5], inertia: [0, 0, 0, 0, 0, 0]}
hinges:
  rail: {type: prismatic, axis: [0, 0, 1], parent: world, child: cart}
  pivot: {type: revolute, axis: [0, 1, 0], parent: cart, child: rod}
motions: {shake: {type: sine, hinge: rail, period: 0.1, amplitude: )"
         << amplitude << "}}\n";
    AnalysedScene c(text.str(), "quadratic");
    c.scene.model->prescribe(c.state);
    const Held held = hold(c, {"rail"});
    EXPECT_FALSE(turning(*c.scene.model, c.state).problem.empty()) << "a sine has no constant rate";
    const TurningForm form = turning_form(*c.dynamics, c.state, held, turning(*c.scene.model, c.state, 0.1));
    return floquet(form.A, form.masses);
  };
  // ω = 20π, l = 0.5: a = −4·9.81/(0.5·ω²) = −0.019879; a₀(q) = −q²/2 + 7q⁴/128 − 29q⁶/2304 gives q = 0.199828, A = q
  // l/2.
  const double critical = 0.199828 * 0.5 / 2;
  EXPECT_FALSE(exponents(0.995 * critical).stable());
  EXPECT_TRUE(exponents(1.005 * critical).stable());
}

}  // namespace
}  // namespace withy::test
