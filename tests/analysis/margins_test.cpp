// Margins of loops by hand: the nearest of several on each side, and the loop that is closed.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

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

}  // namespace
}  // namespace withy
