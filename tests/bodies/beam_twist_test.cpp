/// \file
/// Beams whose sections are turned along them: against turned beams, closed forms and the differential equations.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/bodies/beam_fixture.hpp"
#include "withy/tests/conformance/body_suite.hpp"
#include "withy/tests/conformance/plugins.hpp"

namespace withy::test {
namespace {

constexpr double twisted_length = 1.6, EI_y = 30, EI_z = 4, density = 0.9;

/// Of `modes` polynomials in each plane, and torsion where there is rotary inertia.
std::unique_ptr<Body> twisted_beam(const Value& twist, double modes, double rotary = 0) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto plane = [&](double stiffness, double inertia) {
    Value v = Value::map({{"stiffness", Value(stiffness)},
                          {"modes", Value(modes)},
                          {"family", Value(std::string("orthogonal-polynomials"))}});
    if (inertia > 0) v.set("rotary_inertia", Value(inertia));
    return v;
  };
  std::vector<std::pair<std::string, Value>> members = {{"length", Value(twisted_length)},
                                                        {"mass_per_length", Value(density)},
                                                        {"bending_y", plane(EI_z, rotary)},
                                                        {"bending_z", plane(EI_y, 3 * rotary)}};
  if (twist.kind() != Value::Kind::null) members.emplace_back("twist", twist);
  return make_plugin<Body>(registry, "beam", members);
}

/// From zero at the root to this angle at the tip.
Value growing(double angle) {
  return Value::list({Value::list({Value(0.0), Value(0.0)}), Value::list({Value(twisted_length), Value(angle)})});
}

/// Deflections of a section in its own axes from those in axes that are turned back by β: one matrix for the
/// coordinates too, where both planes have the same functions.
Eigen::MatrixXd turn_of_planes(double beta, Eigen::Index modes) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(modes, modes);
  Eigen::MatrixXd turn(2 * modes, 2 * modes);
  turn << std::cos(beta) * one, std::sin(beta) * one, -std::sin(beta) * one, std::cos(beta) * one;
  return turn;
}

/// Bending stiffness of the section at x in the plane of deflections (y, z), those along y_s = (cos β, sin β) having
/// EI_z.
Eigen::Matrix2d bending(double beta) {
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(beta).toRotationMatrix();
  return axes * Eigen::Vector2d(EI_z, EI_y).asDiagonal() * axes.transpose();
}

/// Stiffness, modal mass with rotary inertia, and what a cut says: those of a straight beam that is turned as a whole.
TEST(BeamTwist, of_one_angle_is_a_beam_that_is_turned_about_its_axis) {
  const double beta = 0.7;
  const auto straight = twisted_beam({}, 4, 0.02), twisted = twisted_beam(Value(beta), 4, 0.02);
  const Eigen::MatrixXd turn = turn_of_planes(beta, 4);
  const Eigen::MatrixXd K = turn.transpose() * straight->shape().stiffness * turn;
  const Eigen::MatrixXd M = turn.transpose() * modal_mass(*straight) * turn;
  EXPECT_LT((twisted->shape().stiffness - K).norm(), 1e-13 * K.norm());
  EXPECT_LT((modal_mass(*twisted) - M).norm(), 1e-13 * M.norm());
  const Matrix3 axes = Eigen::AngleAxisd(beta, Vector3::UnitX()).toRotationMatrix();
  const Matrix3 own = Vector3(0, EI_y, EI_z).asDiagonal();
  EXPECT_LT((twisted->cut(0.4)->stiffness - axes * own * axes.transpose()).norm(), 1e-13 * EI_y);
  expect_body_conforms(*twisted);
}

/// The tip's compliance is ∫ (L − x)² B(x)⁻¹ dx, by Simpson's rule. Twelve polynomials in each plane leave 1e-9 of it
/// at three eighths of a turn.
TEST(BeamTwist, gives_way_at_the_tip_as_the_sections_do_along_it) {
  const double end = 0.75 * std::numbers::pi;
  Eigen::Matrix2d exact = Eigen::Matrix2d::Zero();
  constexpr int pieces = 2000;
  for (int i = 0; i <= pieces; ++i) {
    const double part = static_cast<double>(i) / pieces, arm = twisted_length * (1 - part);
    const double weight = (i == 0 || i == pieces ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * twisted_length / (3 * pieces);
    exact += weight * arm * arm * bending(end * part).inverse();
  }
  const auto body = twisted_beam(growing(end), 12);
  const Eigen::MatrixXd tip = body->station("tip")->phi.bottomRows<2>();
  const Eigen::Matrix2d found = tip * body->shape().stiffness.llt().solve(tip.transpose());
  EXPECT_LT((found - exact).norm(), 1e-9 * exact.norm());
  EXPECT_GT(std::abs(exact(0, 1)), 0.1 * exact(0, 0)) << "the planes are coupled";
}

/// Over whole half turns cos 2β vanishes against what is even about their middles: functions of one curvature
/// everywhere have ½ (EI_y + EI_z) in both planes, however fast the sections turn.
TEST(BeamTwist, of_many_turns_has_the_mean_stiffness_of_both_planes) {
  const auto straight = twisted_beam({}, 1), twisted = twisted_beam(growing(20 * std::numbers::pi), 1);
  // One polynomial that is clamped has one curvature.
  const double mean = straight->shape().stiffness(0, 0) / EI_z * 0.5 * (EI_y + EI_z);
  const Eigen::Matrix2d K = twisted->shape().stiffness;
  EXPECT_LT((K - mean * Eigen::Matrix2d::Identity()).norm(), 1e-12 * mean);
}

/// Turned by `angle` from x = 0.6 m on, within `gap`.
Value jump(double angle, double gap) {
  const auto row = [](double x, double beta) { return Value::list({Value(x), Value(beta)}); };
  return Value::list({row(0, 0), row(0.6, 0), row(0.6 + gap, angle), row(twisted_length, angle)});
}

/// Functions of one curvature have c² ∫ B dx: 0.6 m of the one angle, the rest of the other. What turns within a
/// nanometre takes as many points as what turns within a millimetre, and every cut too.
TEST(BeamTwist, a_jump_costs_what_it_turns_by_however_short_it_is) {
  const double angle = 0.5, gap = 1e-9;
  const auto straight = twisted_beam({}, 1), twisted = twisted_beam(jump(angle, gap), 1, 0.02);
  const double square = straight->shape().stiffness(0, 0) / (EI_z * twisted_length);
  const Eigen::Matrix2d exact = square * (0.6 * bending(0) + (twisted_length - 0.6) * bending(angle));
  EXPECT_LT((twisted->shape().stiffness - exact).norm(), 1e-8 * exact.norm());
  const auto wide = twisted_beam(jump(angle, 1e-3), 1, 0.02);
  EXPECT_EQ(twisted->shape().particles.size(), wide->shape().particles.size());
  EXPECT_EQ(twisted->shape().sections.size(), wide->shape().sections.size());
  EXPECT_EQ(twisted->cut(0.3)->particles.size(), wide->cut(0.3)->particles.size());
  expect_body_conforms(*twisted);
}

/// Turned to β₁ at 0.6 m and back at the tip, without modes: ∫ cos 2β dx = L sin 2β₁/2β₁, so that its rotary inertia is
/// (2r ± r sin 2β₁/2β₁) L about y and z, with 3r and r of the sections.
TEST(BeamTwist, turns_the_inertia_of_a_rigid_beam_between_all_rows) {
  const double r = 0.02, turn = 2;
  const auto row = [](double x, double beta) { return Value::list({Value(x), Value(beta)}); };
  const auto body = twisted_beam(Value::list({row(0, 0), row(0.6, turn), row(twisted_length, 0)}), 0, r);
  Matrix3 sum = Matrix3::Zero();
  for (const withy::Section& s : body->shape().sections) sum += s.inertia;
  const double central = density * std::pow(twisted_length, 3) / 12, swing = std::sin(2 * turn) / (2 * turn);
  EXPECT_NEAR(sum(1, 1), central + r * twisted_length * (2 + swing), 1e-13);
  EXPECT_NEAR(sum(2, 2), central + r * twisted_length * (2 - swing), 1e-13);
}

/// (B d″)″ = μ ω² d with d = (v, w), as four first-order equations of pairs (d, d′, m = B d″, m′) from the root, where
/// d and d′ vanish: the determinant of what m and m′ are at the tip, which is free, by Runge and Kutta's rule.
double free_end(double omega, double end) {
  constexpr int steps = 1500;
  using State = Eigen::Matrix<double, 8, 4>;
  const auto slope = [&](double x, const State& s) {
    State rate;
    rate << s.middleRows<2>(2), bending(end * x / twisted_length).inverse() * s.middleRows<2>(4), s.middleRows<2>(6),
        density * omega * omega * s.topRows<2>();
    return rate;
  };
  State s = State::Zero();
  s.bottomRows<4>().setIdentity();
  const double h = twisted_length / steps;
  for (int i = 0; i < steps; ++i) {
    const double x = h * i;
    const State a = slope(x, s), b = slope(x + h / 2, s + h / 2 * a), c = slope(x + h / 2, s + h / 2 * b),
                d = slope(x + h, s + h * c);
    s += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return s.bottomRows<4>().determinant();
}

/// The determinant changes its sign within 1e-6 of each of the first four frequencies.
TEST(BeamTwist, cantilever_vibrates_as_the_differential_equations_say) {
  const double end = std::numbers::pi / 4;
  const auto body = twisted_beam(growing(end), 12);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(body->shape().stiffness, modal_mass(*body));
  const auto straight = twisted_beam({}, 12);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> plain(straight->shape().stiffness,
                                                                        modal_mass(*straight));
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double omega = std::sqrt(eigen.eigenvalues()[k]);
    EXPECT_LT(free_end(omega * (1 - 1e-6), end) * free_end(omega * (1 + 1e-6), end), 0) << "mode " << k + 1;
  }
  EXPECT_GT(std::abs(std::sqrt(eigen.eigenvalues()[1] / plain.eigenvalues()[1]) - 1), 0.05) << "the twist matters";
}

/// A twist the other way round is the mirror image in the plane of x and y.
TEST(BeamTwist, the_other_way_round_is_the_mirror_image) {
  const auto left = twisted_beam(growing(1.1), 3), right = twisted_beam(growing(-1.1), 3);
  Eigen::VectorXd sign(6);
  sign << 1, 1, 1, -1, -1, -1;
  const Eigen::MatrixXd K = sign.asDiagonal() * left->shape().stiffness * sign.asDiagonal();
  EXPECT_LT((right->shape().stiffness - K).norm(), 1e-14 * K.norm());
}

}  // namespace
}  // namespace withy::test
