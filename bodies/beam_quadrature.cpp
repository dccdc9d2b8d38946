#include "beam_quadrature.hpp"

#include <algorithm>
#include <cmath>

namespace withy {
namespace {

std::vector<double> edges(double length, double wave_number, std::vector<double> kinks) {
  kinks.push_back(0);
  kinks.push_back(length);
  std::sort(kinks.begin(), kinks.end());
  kinks.erase(std::unique(kinks.begin(), kinks.end()), kinks.end());
  std::vector<double> all{0};
  for (std::size_t i = 1; i < kinks.size(); ++i) {
    const double piece = kinks[i] - kinks[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(wave_number * piece / 2.5)));
    for (int k = 1; k < parts; ++k) all.push_back(kinks[i - 1] + piece * k / parts);
    all.push_back(kinks[i]);
  }
  return all;
}

}  // namespace

BeamQuadrature::BeamQuadrature(double length, double wave_number, std::vector<double> kinks)
    : PanelQuadrature(edges(length, wave_number, std::move(kinks)), 20) {}

}  // namespace withy
