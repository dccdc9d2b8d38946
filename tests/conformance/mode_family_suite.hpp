/// \file
/// What any mode family must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

#include "withy/core/plugin/mode_family.hpp"

namespace withy::test {

/// All functions of a family at x: value, slope, curvature.
struct FunctionValues {
  std::vector<double> phi, slope, curvature;
  FunctionValues(const ShapeFunctions& f, double x) : phi(f.count()), slope(f.count()), curvature(f.count()) {
    f.evaluate(x, phi, slope, curvature);
  }
};

/// Slopes and curvatures are derivatives: central differences of step h = 1e-4/β leave (hβ)² ≈ 2e-9 of β φ.
inline void expect_derivatives(const ShapeFunctions& f, double length) {
  const double beta = f.wave_number();
  const double h = 1e-4 / beta;
  for (const double fraction : {0.13, 0.5, 0.77, 0.95}) {
    const double x = fraction * length;
    const FunctionValues now(f, x), ahead(f, x + h), behind(f, x - h);
    for (std::size_t i = 0; i < f.count(); ++i) {
      EXPECT_NEAR((ahead.phi[i] - behind.phi[i]) / (2 * h), now.slope[i], 1e-7 * beta);
      EXPECT_NEAR((ahead.slope[i] - behind.slope[i]) / (2 * h), now.curvature[i], 1e-7 * beta * beta);
    }
  }
}

/// ∫ a_i a_j dx / L by Gauss panels that span at most `phase` of the shortest wave, a being one of the members of
/// FunctionValues.
inline Eigen::MatrixXd gram(const ShapeFunctions& f, double length,
                            std::vector<double> FunctionValues::*member = &FunctionValues::phi, double phase = 4) {
  using Gauss = boost::math::quadrature::gauss<double, 20>;
  const auto n = static_cast<Eigen::Index>(f.count());
  const int panels = 1 + static_cast<int>(f.wave_number() * length / phase);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd of_panel(n, 20);  // a product a panel, for many functions
  for (int p = 0; p < panels; ++p) {
    Eigen::Index column = 0;
    for (std::size_t k = 0; k < 10; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        const double x = length * (p + 0.5 * (1 + sign * Gauss::abscissa()[k])) / panels;
        const FunctionValues v(f, x);
        const Eigen::Map<const Eigen::VectorXd> a((v.*member).data(), n);
        of_panel.col(column++) = std::sqrt(0.5 * Gauss::weights()[k] / panels) * a;
      }
    }
    G += of_panel * of_panel.transpose();
  }
  return G;
}

/// The wave number is honest: panels of the phase that bodies choose integrate products of the functions and of their
/// curvatures (in torsion: slopes) as panels three times as fine do, to rounding of the largest.
inline void expect_wave_number_serves_quadrature(const ShapeFunctions& f, double length) {
  for (const auto member : {&FunctionValues::phi, &FunctionValues::slope, &FunctionValues::curvature}) {
    const Eigen::MatrixXd coarse = gram(f, length, member, 2.5);
    const Eigen::MatrixXd fine = gram(f, length, member, 0.8);
    EXPECT_LE((coarse - fine).cwiseAbs().maxCoeff(), 1e-12 * fine.cwiseAbs().maxCoeff());
  }
}

/// Functions are linearly independent, their derivatives are derivatives, and asking for more changes none. All of them
/// are finite from end to end, and the wave number says how fine they are.
inline void expect_family_conforms(const ModeFamily& family, const BeamData& beam) {
  const std::size_t count = std::min<std::size_t>(family.most(), 6);
  const auto f = family.functions(beam, count);
  ASSERT_NE(f, nullptr);
  ASSERT_EQ(f->count(), count);
  ASSERT_EQ(find_fault(*f, beam, count), "") << "kinks, wave number and derivatives";
  expect_derivatives(*f, beam.length);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(gram(*f, beam.length)).info(), Eigen::Success);
  const auto one = family.functions(beam, 1);
  EXPECT_NEAR(FunctionValues(*one, 0.6 * beam.length).phi[0], FunctionValues(*f, 0.6 * beam.length).phi[0], 1e-13);
  const auto all = family.functions(beam, family.most());
  for (const double fraction : {0.0, 1e-9, 0.3, 0.5, 1 - 1e-9, 1.0}) {
    const FunctionValues v(*all, fraction * beam.length);
    for (std::size_t i = 0; i < all->count(); ++i) {
      EXPECT_TRUE(std::isfinite(v.phi[i]) && std::isfinite(v.slope[i]) && std::isfinite(v.curvature[i]));
    }
  }
  expect_wave_number_serves_quadrature(*family.functions(beam, std::min<std::size_t>(family.most(), 40)), beam.length);
  expect_wave_number_serves_quadrature(*one, beam.length);
}

}  // namespace withy::test
