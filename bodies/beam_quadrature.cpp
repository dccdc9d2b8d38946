#include "beam_quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

/// Panels that span at most `longest` of phase [rad].
std::vector<double> edges(double length, const PhaseBetween& phase, std::vector<double> kinks, double longest) {
  kinks.push_back(0);
  kinks.push_back(length);
  std::sort(kinks.begin(), kinks.end());
  kinks.erase(std::unique(kinks.begin(), kinks.end()), kinks.end());
  std::vector<double> all{0};
  for (std::size_t i = 1; i < kinks.size(); ++i) {
    const double piece = kinks[i] - kinks[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(phase(kinks[i - 1], kinks[i]) / longest)));
    for (int k = 1; k < parts; ++k) all.push_back(kinks[i - 1] + piece * k / parts);
    all.push_back(kinks[i]);
  }
  return all;
}

constexpr Eigen::Index most_nodes = 24;
constexpr double longest_section_panel = 8;  ///< [rad], where most_nodes leave 1e-17

/// ln Γ(x): std::lgamma leaves the sign in a global variable, and beams are made on several threads.
double log_gamma(double x) {
  int sign = 0;
  return lgamma_r(x, &sign);
}

Eigen::Index section_nodes(const std::vector<double>& edges, const PhaseBetween& phase) {
  double longest = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) longest = std::max(longest, phase(edges[i - 1], edges[i]));
  const auto logarithm = [&](double n) {  // of the error
    return 2 * n * std::log(4 * longest) + 4 * log_gamma(n + 1) - std::log(2 * n + 1) - 3 * log_gamma(2 * n + 1);
  };
  Eigen::Index n = 4;
  while (n < most_nodes && !(logarithm(static_cast<double>(n)) < std::log(1e-15))) n += 4;
  return n;
}

}  // namespace

SectionQuadrature::SectionQuadrature(double length, const PhaseBetween& phase, std::vector<double> kinks)
    : PanelQuadrature(edges(length, phase, kinks, longest_section_panel),
                      section_nodes(edges(length, phase, kinks, longest_section_panel), phase)) {}

BeamQuadrature::BeamQuadrature(double length, const PhaseBetween& phase, std::vector<double> kinks)
    : PanelQuadrature(edges(length, phase, std::move(kinks), 2.5), 20) {}

}  // namespace withy
