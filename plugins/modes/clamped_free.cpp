/// \file
/// Eigenfunctions of the uniform clamped-free beam in bending and of the clamped-free rod in torsion.
///
/// Bending, with ξ = x/L, β the roots of cosh β cos β = −1, e = exp(−β): the textbook form
/// cosh βξ − cos βξ − σ (sinh βξ − sin βξ) (Blevins 1979, table 8-1) loses every digit beyond mode 12, since it
/// subtracts numbers as large as exp β. Written with decaying exponentials alone it keeps 1e-13 for 200 modes:
///   D = 1 − e² + 2e sin β,  g = e + cos β − sin β,
///   φ = e^(−βξ) − cos βξ + (1 + 2eg/D) sin βξ − (g/D)(e^(−β(1−ξ)) − e^(−β(1+ξ))).
/// They are normalized ∫₀ᴸ φ² dx = L; φ₁(L) = 2, φ₂(L) = −2.
/// Torsion: φ_k = sin((k − ½) π x/L), of amplitude 1: the twist at the tip is the sum of ±q_k.
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <vector>

#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/mode_family.hpp"

namespace withy {
namespace {

constexpr double pi = boost::math::constants::pi<double>();

/// k-th root (k ≥ 1) of cos β + 1/cosh β = 0; it differs from (k − ½)π by less than 0.31.
double clamped_free_root(std::size_t k) {
  const double start = (static_cast<double>(k) - 0.5) * pi;
  const auto f = [](double b) {
    const double sech = 1 / std::cosh(b);
    return std::make_pair(std::cos(b) + sech, -std::sin(b) - std::tanh(b) * sech);
  };
  return boost::math::tools::newton_raphson_iterate(f, start, start - 0.4, start + 0.4, 53);
}

class BendingFunctions final : public ShapeFunctions {
 public:
  BendingFunctions(double length, std::size_t count) : length_(length) {
    for (std::size_t k = 1; k <= count; ++k) {
      const double beta = clamped_free_root(k);
      const double e = std::exp(-beta);
      const double D = 1 - e * e + 2 * e * std::sin(beta);
      const double g = e + std::cos(beta) - std::sin(beta);
      modes_.push_back({beta, 1 + 2 * e * g / D, g / D});
    }
  }
  std::size_t count() const override { return modes_.size(); }
  double wave_number() const override { return modes_.back().beta / length_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const double xi = x / length_;
    for (std::size_t k = 0; k < modes_.size(); ++k) {
      const auto [beta, s, h] = modes_[k];
      const double b = beta / length_;
      const double root = std::exp(-beta * xi);
      const double tip = std::exp(-beta * (1 - xi));
      const double image = std::exp(-beta * (1 + xi));
      const double sine = std::sin(beta * xi);
      const double cosine = std::cos(beta * xi);
      phi[k] = root - cosine + s * sine - h * (tip - image);
      slope[k] = b * (-root + sine + s * cosine - h * (tip + image));
      curvature[k] = b * b * (root + cosine - s * sine - h * (tip - image));
    }
  }

 private:
  struct Mode {
    double beta, sine, tip;
  };
  double length_;
  std::vector<Mode> modes_;
};

class TorsionFunctions final : public ShapeFunctions {
 public:
  TorsionFunctions(double length, std::size_t count) : length_(length), count_(count) {}
  std::size_t count() const override { return count_; }
  double wave_number() const override { return wave_number(count_); }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    for (std::size_t k = 0; k < count_; ++k) {
      const double b = wave_number(k + 1);
      phi[k] = std::sin(b * x);
      slope[k] = b * std::cos(b * x);
      curvature[k] = -b * b * phi[k];
    }
  }

 private:
  double wave_number(std::size_t k) const { return (static_cast<double>(k) - 0.5) * pi / length_; }
  double length_;
  std::size_t count_;
};

class ClampedFree final : public ModeFamily {
 public:
  std::size_t most() const override { return 200; }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    if (beam.strain == BeamData::Strain::torsion) return std::make_unique<TorsionFunctions>(beam.length, count);
    return std::make_unique<BendingFunctions>(beam.length, count);
  }
};

std::unique_ptr<ModeFamily> make(const Value& /*parameters*/, const MakeContext& /*context*/) {
  return std::make_unique<ClampedFree>();
}

void enroll(Enrollment& enrollment) {
  enrollment.add<ModeFamily>({.id = "clamped-free",
                              .summary = "Eigenfunctions of the uniform beam clamped at the root and free at the tip",
                              .parameters = {},
                              .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(clamped_free, withy::enroll);
