// Margins of loops by hand: the nearest of several on each side, and the loop that is closed.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <random>

#include "withy/core/analysis/frequency_response.hpp"

namespace withy {
namespace {

TEST(Margins, TheNearestOnEachSideCounts) {
  Margins m;
  m.gains = {{1, 8}, {2, 0.2}, {3, 3}, {4, 0.5}, {5, 0.1}};
  m.phases = {{1, 1.2, 1.2}, {2, -0.3, 2.9}, {3, 0.4, 0.133}, {4, -0.8, 1.3}};
  ASSERT_NE(m.upper(), nullptr);
  ASSERT_NE(m.lower(), nullptr);
  EXPECT_EQ(m.upper()->factor, 3);
  EXPECT_EQ(m.lower()->factor, 0.5);
  EXPECT_EQ(m.lag(), nullptr) << "a loop that is not stable has none";
  m.stable = true;
  m.last = 0.9;
  EXPECT_EQ(m.lag()->angle, 0.4);
  EXPECT_EQ(m.lead()->angle, -0.3);
  EXPECT_EQ(m.delay()->delay, 0.133);
  m.last = 1;
  EXPECT_EQ(m.delay(), nullptr) << "where the gain never falls below one any dead time is too much";
}

// ẋ = −x + v, y = 2 x + v/2 with v = r − y: y = (2 x + r/2)/1.5.
TEST(Margins, AClosedLoopPassesItsReferenceOnLessByWhatItFeedsBackAtOnce) {
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  const LinearSystem closed = closed_loop({one(-1), one(1), one(2), one(0.5), 0}, 1);
  EXPECT_NEAR(closed.A(0, 0), -1 - 2 / 1.5, 1e-15);
  EXPECT_NEAR(closed.B(0, 0), 1 / 1.5, 1e-15);
  EXPECT_NEAR(closed.C(0, 0), 2 / 1.5, 1e-15);
  EXPECT_NEAR(closed.D(0, 0), 0.5 / 1.5, 1e-15);
}

/// Two decaying vibrations and the slightest direct way, as of an accelerometer far from the force.
LinearSystem with_little_through(double through) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4, 4), B(4, 1), C(1, 4);
  A.topLeftCorner(2, 2) << -0.3, 10, -10, -0.3;
  A.bottomRightCorner(2, 2) << -0.2, 11, -11, -0.2;
  B << 30, 0, 30, 0;
  C << 1, 0.5, 0.8, -0.3;
  return {A, B, C, Eigen::MatrixXd::Constant(1, 1, through), 0};
}

// Zeros so uncertain that any was within its error of a pole took poles out of the response, and off the static gain.
TEST(Roots, OfASystemWithTheSlightestDirectWayAreAllSeen) {
  for (const double through : {1.0, 1e-4, 1e-6, 1e-8, 1e-10}) {
    constexpr double share = 1e-11;
    const LinearSystem system = with_little_through(through);
    const ZerosAndGain found = zeros(system);
    ASSERT_EQ(found.zeros.values.size(), 4);
    EXPECT_EQ(found.gain, through);
    const SeenRoots seen = seen_roots(system, known_poles(system), found.zeros);
    EXPECT_EQ(seen.hidden.size(), 0) << through;
    const std::complex<double> product = (-seen.zeros).prod() / (-seen.poles).prod() * found.gain;
    const double direct = (system.D - system.C * system.A.inverse() * system.B)(0, 0);
    EXPECT_NEAR(product.real(), direct, share * std::abs(direct)) << through;
    // Far from zeros and poles too.
    for (const std::complex<double> s : {std::complex<double>(3, 8), {-20, 40}, {0.1, 900}}) {
      const Eigen::MatrixXcd M = s * Eigen::MatrixXcd::Identity(4, 4) - system.A;
      const std::complex<double> exact =
          (system.C * M.partialPivLu().solve(system.B.cast<std::complex<double>>()))(0) + through;
      EXPECT_LT(std::abs((s - seen.zeros.array()).prod() / (s - seen.poles.array()).prod() * found.gain - exact),
                share * std::abs(exact))
          << through << s;
    }
  }
}

// One zero, at A − B C/D. It was off by rounding of what the states carry beside D, and by a hundred times what was
// told.
TEST(Roots, FarZerosAreKnownToRoundingOfThemselves) {
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  for (const double period : {0.0, 0.01})
    for (double through = 1.7; std::abs(through) > 1e-10; through *= -0.37) {
      const double a = 0.3, b = 2.9, c = 0.7, exact = a - b * c / through;
      const KnownRoots found = zeros({one(a), one(b), one(c), one(through), period}).zeros;
      ASSERT_EQ(found.values.size(), 1);
      EXPECT_NEAR(found.values[0].real(), exact, 1e-12 * std::abs(exact)) << through;
      EXPECT_EQ(found.values[0].imag(), 0);
      EXPECT_LT(found.errors[0], 1e-11 * std::abs(exact)) << through;
      EXPECT_GE(found.errors[0], std::abs(found.values[0] - exact)) << through;
    }
}

// Zeros of (s + 1)³ over other poles, in the form of a chain: rounding spreads three that are one by its third root,
// which their errors tell.
TEST(Roots, ErrorsOfZerosThatAreOneTellWhatRoundingMakesOfThem) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3), B = Eigen::MatrixXd::Zero(3, 1), C(1, 3);
  A << 0, 1, 0, 0, 0, 1, -24, -26, -9;
  B(2) = 1;
  C << 1 - 24, 3 - 26, 3 - 9;
  const KnownRoots found = zeros({A, B, C, Eigen::MatrixXd::Ones(1, 1), 0}).zeros;
  ASSERT_EQ(found.values.size(), 3);
  for (int i = 0; i < 3; ++i) EXPECT_GE(found.errors[i], std::abs(found.values[i] + 1.0)) << i;
}

/// Unit masses in a row, springs before each, dampers of `damping` times these; a force on the last and the sensor of
/// `seen`, a place or, beyond these, a rate.
LinearSystem row_of_masses(double damping, Eigen::Index count, Eigen::Index seen) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(count, count), A = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  const Eigen::Vector4d springs(0.7, 3.1, 1.9, 5.3);
  for (Eigen::Index i = 0; i < count; ++i) {
    K(i, i) += springs[i];
    if (i > 0) K.block(i - 1, i - 1, 2, 2) += springs[i] * Eigen::Matrix2d{{1, -1}, {-1, 0}};
  }
  A.topRightCorner(count, count).setIdentity();
  A.bottomRows(count) << -K, -damping * K;
  return {A, Eigen::VectorXd::Unit(2 * count, 2 * count - 1), Eigen::RowVectorXd::Unit(2 * count, seen),
          Eigen::MatrixXd::Zero(1, 1), 0};
}

// The rate of the first mass rests where the last is pushed at rest, and nothing else stops it: one zero, at zero. It
// was rounding, and told to be known 1e13 times better.
TEST(Roots, TheZeroOfARateStandsAtZero) {
  const KnownRoots found = zeros(row_of_masses(0, 4, 4)).zeros;
  ASSERT_EQ(found.values.size(), 1);
  EXPECT_EQ(found.values[0], 0.0);
}

// Each spring with its damper passes nothing at −1/0.001: two zeros, which rounding parts.
TEST(Roots, ErrorsOfTwoZerosThatAreOneAreNoLessThanWhatPartsThem) {
  const KnownRoots found = zeros(row_of_masses(1e-3, 3, 0)).zeros;
  ASSERT_EQ(found.values.size(), 2);
  for (int i = 0; i < 2; ++i) EXPECT_GE(found.errors[i], std::abs(found.values[i] + 1000.0)) << i;
  EXPECT_EQ(seen_roots(row_of_masses(1e-3, 3, 0), known_poles(row_of_masses(1e-3, 3, 0)), {found}).hidden.size(), 0);
}

// Where the last is held by the force: the frequencies of the others. Known to some digits more than was told.
TEST(Roots, ErrorsOfZerosAreOfTheSizeOfRounding) {
  const LinearSystem system = row_of_masses(0, 4, 3);
  const KnownRoots found = zeros(system).zeros;
  ASSERT_EQ(found.values.size(), 6);
  const Eigen::Matrix3d held = -system.A.block<3, 3>(4, 0);
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(held).eigenvalues();
  for (int i = 0; i < 6; ++i) {
    const Eigen::Array3d apart = (squares.array().sqrt() - std::abs(found.values[i].imag())).abs();
    EXPECT_GE(found.errors[i], std::hypot(apart.minCoeff(), found.values[i].real())) << i;
    EXPECT_LT(found.errors[i], 1e-12 * std::abs(found.values[i])) << i;
  }
}

// The output sees the first state, and the input moves the others: no rounding makes a gain of that.
TEST(Roots, OfAnOutputThatTheInputDoesNotReachThereAreNone) {
  Eigen::MatrixXd A(3, 3);
  A << 0.3, 0, 0, 0.7, -1.1, 0.4, -0.2, 0.9, 0.6;
  for (const double in : {1.3, 0.7, 0.31, -2.9}) {
    const ZerosAndGain found =
        zeros({A, Eigen::Vector3d(0, in, -0.8), Eigen::RowVector3d(0.9, 0, 0), Eigen::MatrixXd::Zero(1, 1), 0});
    EXPECT_EQ(found.gain, 0) << in;
    EXPECT_EQ(found.zeros.values.size(), 0) << in;
  }
}

/// Undamped, with a force on one coordinate and the place of another: inertias of any condition, stiffnesses of four
/// powers of ten.
LinearSystem undamped_of_any_inertias(std::mt19937& any) {
  const auto one = [&] { return static_cast<double>(any()) / 4294967296.0 - 0.5; };
  const auto matrix = [&](Eigen::Index n) { return Eigen::MatrixXd::NullaryExpr(n, n, one).eval(); };
  const Eigen::Index n = 3 + static_cast<Eigen::Index>(any() % 6);
  const Eigen::MatrixXd R = matrix(n), Q = matrix(n).householderQr().householderQ();
  const Eigen::VectorXd stiffnesses = Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(10, 3 + 4 * one()); });
  const Eigen::LDLT<Eigen::MatrixXd> inertias(R * R.transpose());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n), B = Eigen::MatrixXd::Zero(2 * n, 1);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -inertias.solve(Q * stiffnesses.asDiagonal() * Q.transpose());
  B.bottomRows(n) = inertias.solve(Eigen::VectorXd::Unit(n, static_cast<Eigen::Index>(any() % n)));
  return {A, B, Eigen::RowVectorXd::Unit(2 * n, static_cast<Eigen::Index>(any() % n)), Eigen::MatrixXd::Zero(1, 1), 0};
}

// Of one in a hundred of these QZ comes to no end.
TEST(Roots, AreFoundWhereQzComesToNoEnd) {
  std::mt19937 any(7);
  for (int k = 0; k < 1000; ++k) {
    const LinearSystem system = undamped_of_any_inertias(any);
    const Eigen::Index n = system.A.rows();
    KnownRoots found;
    ASSERT_NO_THROW(found = zeros(system).zeros) << k;
    for (Eigen::Index i = 0; i < found.values.size(); ++i)
      ASSERT_LT(found.errors[i], 1e-3 * (std::abs(found.values[i]) + system.A.norm() / n)) << k;
  }
}

}  // namespace
}  // namespace withy
