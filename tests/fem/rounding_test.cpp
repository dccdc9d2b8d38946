/// \file
/// Stiffness printed with few digits: the frequencies that are told are right, or none is.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reduced_case.hpp"

namespace withy::fem {
namespace {

using testing::HasSubstr;

SparseMatrix printed_with(SparseMatrix K, int digits) {
  for (double& x : K.coeffs()) x = std::stod(fmt::format("{:.{}e}", x, digits - 1));
  return K;
}

/// Of 1 m by 20 mm by 10 mm the lowest frequency is off by 0.6 % with 11 digits, by 6 % with 10, and tenfold with 7.
TEST(Rounding, of_the_stiffness_leaves_frequencies_right_to_a_percent_or_none) {
  const Case c(cantilever, 6);
  EXPECT_LT(c.body.frequency_errors.maxCoeff(), 1e-4) << "14 digits";
  int told = 0, refused = 0;
  for (int digits = 14; digits >= 7; --digits) {
    Matrices m = c.matrices;
    m.K = printed_with(m.K, digits);
    Reduction body;
    const std::string why = refusal([&] { body = reduce(m, c.options); });
    if (!why.empty()) {
      EXPECT_THAT(why, HasSubstr("digits"));
      ++refused;
      continue;
    }
    EXPECT_EQ(refused, 0) << digits << " digits, after fewer were enough";
    ++told;
    for (Eigen::Index k = 0; k < body.omega.size(); ++k) {
      const double error = std::abs(body.omega[k] / c.body.omega[k] - 1);
      EXPECT_LT(error, 0.01) << digits << " digits, mode " << k + 1;
      EXPECT_GT(body.frequency_errors[k], 0.8 * error - 1e-5) << digits << " digits, mode " << k + 1;
    }
    // Of the lowest nothing but rounding is told.
    const double error = std::abs(body.omega[0] / c.body.omega[0] - 1);
    EXPECT_NEAR(body.frequency_errors[0], error, 0.2 * error + 1e-5) << digits << " digits";
  }
  EXPECT_EQ(told, 4) << "14 to 11";
  EXPECT_EQ(refused, 4) << "10 to 7";
}

/// 1 N/m at a node against 4e9 in the matrix passes for a free mesh, but adds to the lowest frequency's 8.36 Hz.
TEST(Rounding, of_which_a_soft_support_has_the_size_is_refused) {
  const Case c(cantilever, 6);
  Matrices m = c.matrices;
  const Eigen::Index tip = c.options.interfaces[0].nodes[0];
  const auto row = 3 * (std::find(m.nodes.begin(), m.nodes.end(), tip) - m.nodes.begin()) + 2;
  m.K.coeffRef(row, row) += 100;
  EXPECT_THAT(refusal([&] { (void)reduce(m, c.options); }), HasSubstr("without supports"));
}

}  // namespace
}  // namespace withy::fem
