/// \file
/// What any mode family must satisfy, built in or foreign.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss.hpp>
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

/// Gram matrix ∫ φ_i φ_j dx / L by Gauss panels fine against the shortest wave.
inline Eigen::MatrixXd gram(const ShapeFunctions& f, double length) {
  using Gauss = boost::math::quadrature::gauss<double, 20>;
  const auto n = static_cast<Eigen::Index>(f.count());
  const int panels = 1 + static_cast<int>(f.wave_number() * length / 4);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
  for (int p = 0; p < panels; ++p) {
    for (std::size_t k = 0; k < 10; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        const double x = length * (p + 0.5 * (1 + sign * Gauss::abscissa()[k])) / panels;
        const FunctionValues v(f, x);
        const Eigen::Map<const Eigen::VectorXd> phi(v.phi.data(), n);
        G += 0.5 * Gauss::weights()[k] / panels * phi * phi.transpose();
      }
    }
  }
  return G;
}

/// Functions are linearly independent, their derivatives are derivatives, and asking for more changes none.
inline void expect_family_conforms(const ModeFamily& family, const BeamData& beam) {
  const std::size_t count = std::min<std::size_t>(family.most(), 6);
  const auto f = family.functions(beam, count);
  ASSERT_NE(f, nullptr);
  ASSERT_EQ(f->count(), count);
  expect_derivatives(*f, beam.length);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(gram(*f, beam.length)).info(), Eigen::Success);
  const auto one = family.functions(beam, 1);
  EXPECT_NEAR(FunctionValues(*one, 0.6 * beam.length).phi[0], FunctionValues(*f, 0.6 * beam.length).phi[0], 1e-13);
}

}  // namespace withy::test
