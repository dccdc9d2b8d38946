#include "panel_functions.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {
namespace {

constexpr Eigen::Index order = PanelFunctions::order;

/// Legendre polynomials at s in [−1, 1], their derivatives, and their first and second integrals from −1.
struct LegendreAt {
  std::array<double, order + 2> P, once{}, twice{}, slope{};

  explicit LegendreAt(double s) {
    P[0] = 1, P[1] = s;
    slope[1] = 1;
    for (std::size_t k = 1; k + 1 < P.size(); ++k) {
      const auto n = static_cast<double>(k);
      P[k + 1] = ((2 * n + 1) * s * P[k] - n * P[k - 1]) / (n + 1);
      slope[k + 1] = slope[k - 1] + (2 * n + 1) * P[k];
    }
    // ∫ P_k = (P_{k+1} − P_{k−1})/(2k + 1), which is zero at −1.
    once[0] = s + 1;
    for (std::size_t k = 1; k < order + 1; ++k) once[k] = (P[k + 1] - P[k - 1]) / static_cast<double>(2 * k + 1);
    twice[0] = 0.5 * (s + 1) * (s + 1);
    for (std::size_t k = 1; k < order; ++k) twice[k] = (once[k + 1] - once[k - 1]) / static_cast<double>(2 * k + 1);
  }
};

/// Coefficients of the polynomial through the values at the nodes of [−1, 1]: (2k + 1)/2 Σ w_j P_k(s_j) f(s_j).
Eigen::MatrixXd to_series() {
  const PanelQuadrature rule({-1, 1}, order);
  Eigen::MatrixXd to(order, order);
  for (Eigen::Index j = 0; j < order; ++j) {
    // The quadrature counts from the first edge.
    const LegendreAt at(rule.nodes()[static_cast<std::size_t>(j)]);
    for (Eigen::Index k = 0; k < order; ++k)
      to(k, j) = 0.5 * static_cast<double>(2 * k + 1) * rule.weights()[static_cast<std::size_t>(j)] *
                 at.P[static_cast<std::size_t>(k)];
  }
  return to;
}

}  // namespace

PanelFunctions::PanelFunctions(BeamData::Strain strain, std::vector<double> edges, const Eigen::MatrixXd& strains,
                               double wave_number, std::vector<double> kinks)
    : bends_(strain == BeamData::Strain::bending),
      edges_(std::move(edges)),
      kinks_(std::move(kinks)),
      wave_number_(wave_number),
      series_(strains.rows(), strains.cols()) {
  const Eigen::MatrixXd to = to_series();
  const auto panels = static_cast<Eigen::Index>(edges_.size()) - 1;
  root_ = root_slope_ = Eigen::MatrixXd::Zero(panels + 1, strains.cols());
  for (Eigen::Index p = 0; p < panels; ++p) {
    auto series = series_.middleRows(p * order, order);
    series = to * strains.middleRows(p * order, order);
    const double length = edges_[static_cast<std::size_t>(p) + 1] - edges_[static_cast<std::size_t>(p)];
    const double half = 0.5 * length;
    // Over a whole panel ∫ P_0 = 2, ∫∫ P_0 = 2, ∫∫ P_1 = −2/3, and no other is left.
    if (bends_) {
      root_slope_.row(p + 1) = root_slope_.row(p) + length * series.row(0);
      root_.row(p + 1) =
          root_.row(p) + length * root_slope_.row(p) + half * half * (2 * series.row(0) - 2.0 / 3 * series.row(1));
    } else {
      root_.row(p + 1) = root_.row(p) + length * series.row(0);
    }
  }
}

void PanelFunctions::evaluate(double x, std::span<double> phi, std::span<double> slope,
                              std::span<double> curvature) const {
  const auto after = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, x);
  const auto p = after - edges_.begin() - 1;
  const double from = edges_[static_cast<std::size_t>(p)], half = 0.5 * (*after - from);
  const LegendreAt at((x - from) / half - 1);
  const auto sum = [&](Eigen::Index i, const std::array<double, order + 2>& values) {
    const auto series = series_.col(i).segment<order>(p * order);
    double total = 0;
    for (Eigen::Index k = 0; k < order; ++k) total += series[k] * values[static_cast<std::size_t>(k)];
    return total;
  };
  for (std::size_t i = 0; i < count(); ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    if (bends_) {
      phi[i] = root_(p, c) + root_slope_(p, c) * (x - from) + half * half * sum(c, at.twice);
      slope[i] = root_slope_(p, c) + half * sum(c, at.once);
      curvature[i] = sum(c, at.P);
    } else {
      phi[i] = root_(p, c) + half * sum(c, at.once);
      slope[i] = sum(c, at.P);
      curvature[i] = sum(c, at.slope) / half;
    }
  }
}

}  // namespace withy
