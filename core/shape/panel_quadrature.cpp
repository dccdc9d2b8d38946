#include "withy/core/shape/panel_quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <utility>

namespace withy {
namespace {

/// P_0(s) … P_degree(s) by the three-term recurrence.
Eigen::VectorXd legendre(Eigen::Index degree, double s) {
  Eigen::VectorXd P = Eigen::VectorXd::Ones(degree + 1);
  if (degree > 0) P[1] = s;
  for (Eigen::Index k = 1; k < degree; ++k) {
    const auto a = static_cast<double>(k);
    P[k + 1] = ((2 * a + 1) * s * P[k] - a * P[k - 1]) / (a + 1);
  }
  return P;
}

std::vector<double> equal_edges(double length, Eigen::Index panels) {
  std::vector<double> edges;
  for (Eigen::Index p = 0; p < panels; ++p)
    edges.push_back(length * static_cast<double>(p) / static_cast<double>(panels));
  edges.push_back(length);
  return edges;
}

/// The Gauss rule of an order on [−1, 1]. It takes longer than all else here and depends on nothing else, so that
/// bodies and the cases of a sweep share it.
struct GaussRule {
  /// Roots and weights by Newton's iteration from Tricomi's estimate, in long double so that they are right to
  /// rounding.
  explicit GaussRule(Eigen::Index order)
      : node(order), weight(order), legendre_at_node(order, order + 1), running(order, order) {
    const auto n = static_cast<long double>(order);
    for (Eigen::Index i = 0; i < order; ++i) {
      long double s = -std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.75L) / (n + 0.5L));
      long double slope = 1;
      for (int iteration = 0; iteration < 10; ++iteration) {
        long double before = 1, p = s;
        for (long double k = 1; k < n; ++k) {
          const long double next = ((2 * k + 1) * s * p - k * before) / (k + 1);
          before = p;
          p = next;
        }
        slope = n * (before - s * p) / (1 - s * s);
        s -= p / slope;
      }
      node[i] = static_cast<double>(s);
      weight[i] = static_cast<double>(2 / ((1 - s * s) * slope * slope));
    }
    for (Eigen::Index j = 0; j < order; ++j) legendre_at_node.row(j) = legendre(order, node[j]).transpose();
    for (Eigen::Index i = 0; i < order; ++i) running.row(i) = partial_weights(node[i]);
  }

  /// Weights of ∫₋₁^s f from the values at the nodes: the interpolant in Legendre polynomials,
  /// Σ_k (2k+1)/2 P_k(ξ_j) w_j, integrated with ∫₋₁^s P_k = (P_{k+1}(s) − P_{k−1}(s))/(2k+1).
  [[nodiscard]] Eigen::RowVectorXd partial_weights(double s) const {
    const Eigen::Index order = node.size();
    const Eigen::VectorXd at_end = legendre(order, s);
    Eigen::RowVectorXd w(order);
    for (Eigen::Index j = 0; j < order; ++j) {
      double sum = 0.5 * (s + 1);
      for (Eigen::Index k = 1; k < order; ++k) sum += 0.5 * legendre_at_node(j, k) * (at_end[k + 1] - at_end[k - 1]);
      w[j] = weight[j] * sum;
    }
    return w;
  }

  Eigen::VectorXd node, weight;      ///< nodes increase
  Eigen::MatrixXd legendre_at_node;  ///< P_0 … P_order, a row each node
  Eigen::MatrixXd running;           ///< row i: partial_weights of node i
};

/// Made when it is first asked for, by whichever thread.
const GaussRule& gauss_rule(Eigen::Index order) {
  static std::mutex mutex;
  static std::map<Eigen::Index, const GaussRule> rules;
  const std::lock_guard lock(mutex);
  return rules.try_emplace(order, order).first->second;
}

}  // namespace

PanelQuadrature::PanelQuadrature(double length, Eigen::Index panels, Eigen::Index order)
    : PanelQuadrature(equal_edges(length, panels), order) {}

PanelQuadrature::PanelQuadrature(std::vector<double> edges, Eigen::Index order)
    : edges_(std::move(edges)), order_(order) {
  const GaussRule& rule = gauss_rule(order);
  node_ = rule.node;
  weight_ = rule.weight;
  running_ = half_length(0) * rule.running;
  for (Eigen::Index p = 0; p < panels(); ++p) {
    for (Eigen::Index j = 0; j < order_; ++j) {
      nodes_.push_back(edges_[static_cast<std::size_t>(p)] + half_length(p) * (1 + node_[j]));
      weights_.push_back(half_length(p) * weight_[j]);
    }
  }
}

double PanelQuadrature::half_length(Eigen::Index panel) const {
  const auto p = static_cast<std::size_t>(panel);
  return 0.5 * (edges_[p + 1] - edges_[p]);
}

Eigen::RowVectorXd PanelQuadrature::partial_weights(double s) const { return gauss_rule(order_).partial_weights(s); }

Eigen::MatrixXd PanelQuadrature::running_integral(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd result(values.rows(), values.cols());
  Eigen::RowVectorXd before = Eigen::RowVectorXd::Zero(values.cols());
  for (Eigen::Index p = 0; p < panels(); ++p) {
    const auto panel = values.middleRows(p * order_, order_);
    const double scale = half_length(p) / half_length(0);
    result.middleRows(p * order_, order_) = (scale * running_ * panel).rowwise() + before;
    before += half_length(p) * weight_.transpose() * panel;
  }
  return result;
}

Eigen::RowVectorXd PanelQuadrature::weights_to(double x) const {
  Eigen::RowVectorXd w = Eigen::RowVectorXd::Zero(panels() * order_);
  const auto after = std::upper_bound(edges_.begin(), edges_.end(), x);
  const auto whole = std::min<Eigen::Index>(after - edges_.begin() - 1, panels());
  for (Eigen::Index j = 0; j < whole * order_; ++j) w[j] = weights_[static_cast<std::size_t>(j)];
  if (whole < panels()) {
    const double s = (x - edges_[static_cast<std::size_t>(whole)]) / half_length(whole) - 1;
    w.segment(whole * order_, order_) = half_length(whole) * partial_weights(s);
  }
  return w;
}

Eigen::RowVectorXd PanelQuadrature::integral_to(double x, const Eigen::MatrixXd& values) const {
  return weights_to(x) * values;
}

}  // namespace withy
