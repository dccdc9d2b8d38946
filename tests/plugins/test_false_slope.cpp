// What is said to be a derivative is wrong where differences that can tell say so, and not where they cannot.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "withy/core/plugin/false_slope.hpp"

namespace {

/// Whether a number is found wrong as the slope of f at 0, by steps of 0.01 and less.
template <class Function>
bool is_wrong(Function&& f, double said, double place = 0) {
  const auto number = [](double x) { return Eigen::RowVectorXd::Constant(1, x); };
  const auto matrix = [&](double x) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(1, 1, f(x)); };
  return withy::false_slope({number(said), number(std::abs(said)), number(0)}, matrix, 0.01, place).has_value();
}

TEST(FalseSlope, tells_a_factor_that_is_forgotten_at_any_scale) {
  for (double scale = 1; scale > 1e-7; scale /= 10) {
    const auto f = [&](double x) { return std::sin(1 + x / scale); };
    EXPECT_FALSE(is_wrong(f, std::cos(1) / scale)) << scale;
    EXPECT_TRUE(is_wrong(f, 1.001 * std::cos(1) / scale)) << scale;
    EXPECT_TRUE(is_wrong(f, 0)) << scale;
  }
  EXPECT_TRUE(is_wrong([](double) { return 3.0; }, 1));
  EXPECT_TRUE(is_wrong([](double x) { return x; }, std::nan(""))) << "no number";
}

TEST(FalseSlope, says_nothing_of_what_is_faster_than_its_steps) {
  for (double rate = 3e9; rate < 1e14; rate *= 1.07)
    EXPECT_FALSE(is_wrong([&](double x) { return std::sin(1 + rate * x); }, rate * std::cos(1))) << rate;
}

TEST(FalseSlope, says_nothing_where_a_function_rounds_its_argument_to_stairs) {
  for (double far = 1e7; far < 1e14; far *= 3) {
    EXPECT_FALSE(is_wrong([&](double x) { return (0.3 + x + far) - far; }, 1)) << far;
    EXPECT_FALSE(
        is_wrong([&](double x) { return std::sin(25.2 * (0.3 + x + far)); }, 25.2 * std::cos(25.2 * (0.3 + far))))
        << far;
    EXPECT_FALSE(is_wrong([&](double x) { return (far + x) - far; }, 1, far)) << far;
  }
  EXPECT_TRUE(is_wrong([](double x) { return (1e7 + x) - 1e7; }, 2)) << "what its longer steps can tell";
  EXPECT_TRUE(is_wrong([](double x) { return (1e10 + x) - 1e10; }, 2, 1e10)) << "what steps that it resolves can tell";
}

TEST(FalseSlope, says_nothing_at_a_kink_and_tells_what_is_wrong_beside_it) {
  const auto kinked = [](double beside) {
    return [beside](double x) { return std::sin(x + beside) + std::max(x + beside, 0.0); };
  };
  for (const double said : {1.0, 1.5, 2.0, 7.0}) EXPECT_FALSE(is_wrong(kinked(0), said)) << said;
  for (const double beside : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    EXPECT_FALSE(is_wrong(kinked(beside), 1 + std::cos(beside))) << beside;
    EXPECT_FALSE(is_wrong(kinked(-beside), std::cos(beside))) << beside;
    EXPECT_TRUE(is_wrong(kinked(beside), 1.7)) << beside;
    EXPECT_TRUE(is_wrong(kinked(-beside), 1.7)) << beside;
  }
  for (const double beside : {1e-8, 1e-9, 1e-10, 1e-12, 1e-14}) {
    EXPECT_FALSE(is_wrong(kinked(beside), 1 + std::cos(beside))) << beside;
    EXPECT_FALSE(is_wrong(kinked(-beside), std::cos(beside))) << beside;
  }
}

TEST(FalseSlope, says_nothing_where_a_function_is_not_defined_to_one_side) {
  EXPECT_FALSE(is_wrong([](double x) { return std::sqrt(x); }, 7));
  const auto root = [](double x) { return std::sqrt(1e-4 + x); };
  EXPECT_FALSE(is_wrong(root, 50));
  EXPECT_TRUE(is_wrong(root, 51)) << "steps that stay inside can tell";
}

}  // namespace
