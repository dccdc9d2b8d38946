// Sines and cosines of the sweeps against those of the library in more digits.
#include "withy/core/sweep/sine_cosine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace withy::sweep {
namespace {

/// Angles of all sizes up to and beyond what the polynomials are for, and next to multiples of π/2, where one of the
/// two is nearly zero.
std::vector<double> angles() {
  std::vector<double> all = {0.0, 1e-300, 1e-20, 0x1p-30, furthest_angle, 1.5 * furthest_angle, 1e22};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-12, 5.2), near(-1e-9, 1e-9);
  for (int i = 0; i < 20000; ++i) all.push_back(std::pow(10, exponent(random)));
  for (int k = 0; k < 60000; k += 7) all.push_back(k * std::numbers::pi / 2 + near(random));
  for (std::size_t i = 0, n = all.size(); i < n; ++i) all.push_back(-all[i]);
  return all;
}

// One unit in the last place of 1: the library's own are off by half of that.
constexpr long double most = std::numeric_limits<double>::epsilon();

TEST(SineCosine, of_an_angle_are_right_to_the_last_place_of_one) {
  long double worst = 0;
  for (const double angle : angles()) {
    double s = 0, c = 0;
    sine_cosine(angle, s, c);
    worst = std::max({worst, std::abs(s - sinl(angle)), std::abs(c - cosl(angle))});
  }
  EXPECT_LE(worst, most);
}

TEST(SineCosine, of_several_angles_are_those_of_each) {
  const std::vector<double> all = angles();
  for (std::size_t i = 0; i + lanes <= all.size(); i += lanes) {
    Pack angle = spread(0.0), sine, cosine;
    for (std::size_t k = 0; k < lanes; ++k) set_lane(angle, k, all[i + k]);
    sine_cosine(angle, sine, cosine);
    for (std::size_t k = 0; k < lanes; ++k) {
      if (std::abs(all[i + k]) >= furthest_angle) continue;
      double s = 0, c = 0;
      sine_cosine(all[i + k], s, c);
      EXPECT_EQ(sine[k], s) << all[i + k];
      EXPECT_EQ(cosine[k], c) << all[i + k];
    }
  }
}

TEST(SineCosine, of_what_is_no_number_are_none) {
  for (const double angle : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    double s = 0, c = 0;
    sine_cosine(angle, s, c);
    EXPECT_TRUE(std::isnan(s) && std::isnan(c));
  }
}

}  // namespace
}  // namespace withy::sweep
