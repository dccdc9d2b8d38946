// Estimates against closed forms and published numbers.
#include "withy/campaign/estimates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "withy/campaign/random.hpp"

namespace withy::campaign {
namespace {

constexpr double pi = std::numbers::pi;

/// Ishigami and Homma (1990) with a = 7, b = 0.1.
double ishigami(const std::vector<double>& u) {
  const auto x = [&](std::size_t i) { return pi * (2 * u[i] - 1); };
  return std::sin(x(0)) + 7 * std::sin(x(1)) * std::sin(x(1)) + 0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

TEST(SobolIndices, OfIshigamisFunctionAreThePublishedOnes) {
  std::vector<SaltelliSample> samples;
  for (std::uint64_t i = 0; i < 4096; ++i) {
    const std::vector<double> p = sobol_point(Key(5), i, 6);
    const std::vector<double> a(p.begin(), p.begin() + 3), b(p.begin() + 3, p.end());
    SaltelliSample s{ishigami(a), ishigami(b), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> mixed = a;
      mixed[k] = b[k];
      s.mixed.push_back(ishigami(mixed));
    }
    samples.push_back(std::move(s));
  }
  const std::vector<SobolIndex> found = sobol_indices(samples);
  const double first[] = {0.3139, 0.4424, 0.0}, total[] = {0.5576, 0.4424, 0.2437};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i].first.value, first[i], 0.01);
    EXPECT_NEAR(found[i].total.value, total[i], 0.01);
    EXPECT_LE(found[i].first.low, first[i]);
    EXPECT_GE(found[i].first.high, first[i]);
    EXPECT_LT(found[i].total.high - found[i].total.low, 0.1);
  }
}

/// Intervals hold the truth in 95 of 100 samples: of a linear function of two parameters with weights 2 and 1 in random
/// samples the first index is 0.8.
TEST(SobolIndices, IntervalsHoldTheTruthAsOftenAsTheySay) {
  int held = 0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<SaltelliSample> samples;
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Key key = Key(static_cast<std::uint64_t>(trial))[i];
      const double a0 = key[0].uniform(), a1 = key[1].uniform(), b0 = key[2].uniform(), b1 = key[3].uniform();
      samples.push_back({2 * a0 + a1, 2 * b0 + b1, {2 * b0 + a1, 2 * a0 + b1}});
    }
    const Estimate e = sobol_indices(samples)[0].first;
    held += e.low <= 0.8 && 0.8 <= e.high ? 1 : 0;
  }
  EXPECT_NEAR(held, 0.95 * trials, 18);  // four deviations of the count
}

// Of two samples by hand: about the mean 2 of all points the variances are 2 and 5. The interval is that of the ratio
// linearized, (a_j - r b_j)/b.
TEST(SobolIndices, AreRatiosOfMeansOverAllPointsWithTheDeviationsOfRatios) {
  const std::vector<SaltelliSample> samples = {{0, 2, {1}}, {1, 5, {4}}};
  const SobolIndex index = sobol_indices(samples)[0];
  EXPECT_DOUBLE_EQ(index.first.value, 4.5 / 3.5);
  EXPECT_DOUBLE_EQ(index.total.value, 2.5 / 3.5);
  EXPECT_NEAR(index.first.high - index.first.value, 1.959964 * 36 / 49, 1e-6);
  EXPECT_NEAR(index.total.high - index.total.value, 1.959964 * 13 / 49, 1e-6);
  EXPECT_NEAR(index.first.high + index.first.low, 2 * index.first.value, 1e-14);
}

TEST(Morris, MeasuresOfEffects) {
  const MorrisMeasure m = morris_measure({1, -3, 2, 4});
  EXPECT_DOUBLE_EQ(m.mean, 1.0);
  EXPECT_DOUBLE_EQ(m.mean_size.value, 2.5);
  EXPECT_NEAR(m.deviation, std::sqrt(26.0 / 3), 1e-14);
}

TEST(Morris, TheIntervalOfAMeanOfSizesDoesNotBeginBelowZero) {
  const Estimate of = morris_measure({0.1, -4}).mean_size;
  EXPECT_EQ(of.low, 0);
  EXPECT_GT(of.high, of.value);
}

TEST(Morris, OfOneEffectThereIsNoInterval) {
  const Estimate one = morris_measure({-3}).mean_size;
  EXPECT_DOUBLE_EQ(one.value, 3);
  EXPECT_TRUE(std::isinf(one.low) && std::isinf(one.high));
}

TEST(Statistics, QuantilesAreThoseOfTheSortedSample) {
  constexpr std::array<double, 7> shares = {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};
  for (const std::size_t size : {1u, 2u, 3u, 10u, 97u, 1000u}) {
    std::vector<double> sample;
    const Key key = Key(11)[size];
    for (std::size_t i = 0; i < size; ++i) sample.push_back(std::floor(30 * key[i].uniform()));  // many are equal
    std::vector<double> sorted = sample;
    std::sort(sorted.begin(), sorted.end());
    const std::vector<double> found = percentiles(sample, shares);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const double place = shares[k] * static_cast<double>(size - 1);
      const auto below = static_cast<std::size_t>(place);
      const double low = sorted[below], high = sorted[std::min(below + 1, size - 1)];
      EXPECT_EQ(found[k], low + (place - static_cast<double>(below)) * (high - low)) << size << " " << shares[k];
    }
    const Statistics s = statistics(sample);
    EXPECT_EQ(s.least, sorted.front());
    EXPECT_EQ(s.greatest, sorted.back());
  }
}

TEST(Statistics, IntervalsAreThoseOfTheTables) {
  std::vector<double> sample;
  for (int i = 1; i <= 100; ++i) sample.push_back((i * 37) % 101);  // 1 to 100 in another order
  const Statistics s = statistics(sample);
  EXPECT_DOUBLE_EQ(s.mean, 50.5);
  EXPECT_NEAR(s.deviation, std::sqrt(100.0 * 101 / 12), 1e-12);
  ASSERT_TRUE(s.mean_interval);
  EXPECT_NEAR(s.mean_interval->high - 50.5, 1.98422 * s.deviation / 10, 1e-3);  // t of 99 degrees of freedom
  EXPECT_DOUBLE_EQ(s.quantiles[1].value, 50.5);
  EXPECT_EQ(s.quantiles[1].low, 40) << "order statistics 40 and 61 hold the median of 100 (tables of the sign test)";
  EXPECT_EQ(s.quantiles[1].high, 61);
  EXPECT_NEAR(share(0, 10).high, 0.3085, 1e-4);  // Clopper and Pearson
  EXPECT_NEAR(share(5, 10).low, 0.1871, 1e-4);
  EXPECT_FALSE(statistics({3}).mean_interval);
}

// Of n draws the greatest is below the 95 % quantile with probability 0.95^n, which is 2.5 % from 72 on.
TEST(Statistics, SaysNoEndsThatASampleIsTooSmallFor) {
  for (const std::size_t n : {20U, 71U, 72U}) {
    std::vector<double> sample(n);
    std::iota(sample.begin(), sample.end(), 1.0);
    const std::vector<Estimate> q = statistics(sample).quantiles;
    EXPECT_EQ(std::isfinite(q[0].low), n >= 72) << n;
    EXPECT_EQ(std::isfinite(q[2].high), n >= 72) << n;
    EXPECT_TRUE(std::isfinite(q[1].low) && std::isfinite(q[1].high)) << n;
  }
  std::vector<double> sample(72);
  std::iota(sample.begin(), sample.end(), 1.0);
  EXPECT_EQ(statistics(sample).quantiles[2].high, 72);
}

}  // namespace
}  // namespace withy::campaign
