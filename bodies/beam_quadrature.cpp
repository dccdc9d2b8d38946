#include "beam_quadrature.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>

namespace withy {
namespace {

constexpr Eigen::Index order = 20;

/// Nodes and weights of the rule on [−1, 1], increasing.
struct Rule {
  Eigen::Matrix<double, order, 1> node, weight;
  Rule() {
    using Gauss = boost::math::quadrature::gauss<double, order>;
    for (Eigen::Index i = 0; i < order / 2; ++i) {
      const auto k = static_cast<std::size_t>(i);
      node[order / 2 + i] = Gauss::abscissa()[k];
      node[order / 2 - 1 - i] = -Gauss::abscissa()[k];
      weight[order / 2 + i] = weight[order / 2 - 1 - i] = Gauss::weights()[k];
    }
  }
};

const Rule& rule() {
  static const Rule r;
  return r;
}

/// Weights of ∫₋₁^s f from the nodes' values: the interpolant in Legendre polynomials, Σ_k (2k+1)/2 P_k(ξ_j) w_j,
/// integrated with ∫₋₁^s P_k = (P_{k+1}(s) − P_{k−1}(s))/(2k+1).
Eigen::Matrix<double, 1, order> partial_weights(double s) {
  Eigen::Matrix<double, 1, order> w;
  for (Eigen::Index j = 0; j < order; ++j) {
    double sum = 0.5 * (s + 1);
    for (int k = 1; k < order; ++k) {
      sum += 0.5 * boost::math::legendre_p(k, rule().node[j]) *
             (boost::math::legendre_p(k + 1, s) - boost::math::legendre_p(k - 1, s));
    }
    w[j] = rule().weight[j] * sum;
  }
  return w;
}

}  // namespace

BeamQuadrature::BeamQuadrature(double length, double wave_number, std::vector<double> kinks) {
  kinks.push_back(0);
  kinks.push_back(length);
  std::sort(kinks.begin(), kinks.end());
  kinks.erase(std::unique(kinks.begin(), kinks.end()), kinks.end());
  edges_.push_back(0);
  for (std::size_t i = 1; i < kinks.size(); ++i) {
    const double piece = kinks[i] - kinks[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(wave_number * piece / 2.5)));
    for (int k = 1; k < parts; ++k) edges_.push_back(kinks[i - 1] + piece * k / parts);
    edges_.push_back(kinks[i]);
  }
  for (Eigen::Index p = 0; p < panels(); ++p) {
    for (Eigen::Index j = 0; j < order; ++j) {
      nodes_.push_back(edges_[static_cast<std::size_t>(p)] + half_length(p) * (1 + rule().node[j]));
      weights_.push_back(half_length(p) * rule().weight[j]);
    }
  }
}

double BeamQuadrature::half_length(Eigen::Index panel) const {
  const auto p = static_cast<std::size_t>(panel);
  return 0.5 * (edges_[p + 1] - edges_[p]);
}

Eigen::MatrixXd BeamQuadrature::running_integral(const Eigen::MatrixXd& values) const {
  static const Eigen::MatrixXd to_node = [] {
    Eigen::MatrixXd m(order, order);
    for (Eigen::Index i = 0; i < order; ++i) m.row(i) = partial_weights(rule().node[i]);
    return m;
  }();
  Eigen::MatrixXd result(values.rows(), values.cols());
  Eigen::RowVectorXd before = Eigen::RowVectorXd::Zero(values.cols());
  for (Eigen::Index p = 0; p < panels(); ++p) {
    const auto panel = values.middleRows(p * order, order);
    result.middleRows(p * order, order) = (half_length(p) * to_node * panel).rowwise() + before;
    before += half_length(p) * rule().weight.transpose() * panel;
  }
  return result;
}

Eigen::RowVectorXd BeamQuadrature::integral_to(double x, const Eigen::MatrixXd& values) const {
  const auto after = std::upper_bound(edges_.begin(), edges_.end(), x);
  const auto whole = std::min<Eigen::Index>(after - edges_.begin() - 1, panels());
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(values.cols());
  for (Eigen::Index p = 0; p < whole; ++p) {
    sum += half_length(p) * rule().weight.transpose() * values.middleRows(p * order, order);
  }
  if (whole < panels()) {
    const double s = (x - edges_[static_cast<std::size_t>(whole)]) / half_length(whole) - 1;
    sum += half_length(whole) * partial_weights(s) * values.middleRows(whole * order, order);
  }
  return sum;
}

}  // namespace withy
