/// \file
/// Orthogonal polynomials that are clamped at the root.
///
/// With ξ = x/L and t = 2ξ − 1: φ_n = c_n ξᵐ P_n^(0,2m)(t), n = 0, 1, …, the Jacobi polynomials being orthogonal on
/// [0, L] with the weight ξ²ᵐ (Abramowitz & Stegun 22.2.1). Bending: m = 2, so φ = φ′ = 0 at the root, and
/// c_n = √(2n + 5), so ∫₀ᴸ φ_i φ_j dx = L δ_ij. Torsion: m = 1, c_n = 1, twist 1 at the tip.
/// Values, first and second derivatives (A&S 22.8; P_n^(a,b)′ = ½ (n + a + b + 1) P_{n−1}^(a+1,b+1)) come from the
/// three-term recurrence (22.7.1), stable on [−1, 1]: 1e-12 for 200 functions. There are 100, since beyond that the
/// panels of a beam's quadrature, equally long, no longer integrate their products near the ends to 1e-12.
#include <cmath>

#include "mode_family_plugin.hpp"

namespace withy {
namespace orthogonal_polynomials {

/// P_n^(a,b)(t) for n = 0, 1, … in turn.
class JacobiSequence {
 public:
  JacobiSequence(double a, double b, double t) : a_(a), b_(b), t_(t) {}
  /// The polynomial of the degree reached, 0 at first.
  double value() const { return now_; }
  void advance() {
    const double s = 2 * n_ + a_ + b_;
    double next = 0;
    if (n_ == 0) {
      next = 0.5 * (a_ - b_ + (s + 2) * t_);
    } else {
      next = ((s + 1) * ((s + 2) * s * t_ + a_ * a_ - b_ * b_) * now_ - 2 * (n_ + a_) * (n_ + b_) * (s + 2) * before_) /
             (2 * (n_ + 1) * (n_ + a_ + b_ + 1) * s);
    }
    before_ = now_;
    now_ = next;
    ++n_;
  }

 private:
  double a_, b_, t_;
  double n_ = 0, now_ = 1, before_ = 0;
};

class ClampedPolynomials final : public ShapeFunctions {
 public:
  ClampedPolynomials(double length, std::size_t count, int power, bool normalized)
      : length_(length), count_(count), power_(power), normalized_(normalized) {}
  std::size_t count() const override { return count_; }
  /// A Jacobi polynomial of degree n is like cos(nϑ), t = cos ϑ: its phase grows by 2n dξ amid the beam. Towards the
  /// ends it grows faster, but over few half waves.
  double wave_number() const override { return 2 * static_cast<double>(count_ + 1) / length_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const double xi = x / length_;
    const double b = 2 * power_;
    JacobiSequence P(0, b, 2 * xi - 1), P1(1, b + 1, 2 * xi - 1), P2(2, b + 2, 2 * xi - 1);
    const double m = power_;
    const double f = power_ == 2 ? xi * xi : xi;
    const double f1 = power_ == 2 ? 2 * xi : 1;
    const double f2 = power_ == 2 ? 2 : 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double n = static_cast<double>(k);
      const double c = normalized_ ? std::sqrt(2 * n + 2 * m + 1) : 1;
      // dt/dξ = 2
      const double p1 = k < 1 ? 0 : (n + b + 1) * P1.value();
      const double p2 = k < 2 ? 0 : (n + b + 1) * (n + b + 2) * P2.value();
      phi[k] = c * f * P.value();
      slope[k] = c * (f1 * P.value() + f * p1) / length_;
      curvature[k] = c * (f2 * P.value() + 2 * f1 * p1 + f * p2) / (length_ * length_);
      P.advance();
      if (k >= 1) P1.advance();
      if (k >= 2) P2.advance();
    }
  }

 private:
  double length_;
  std::size_t count_;
  int power_;
  bool normalized_;
};

std::unique_ptr<ShapeFunctions> bending(const BeamData& beam, std::size_t count) {
  return std::make_unique<ClampedPolynomials>(beam.length, count, 2, true);
}

std::unique_ptr<ShapeFunctions> torsion(const BeamData& beam, std::size_t count) {
  return std::make_unique<ClampedPolynomials>(beam.length, count, 1, false);
}

}  // namespace orthogonal_polynomials

void enroll_orthogonal_polynomials(Enrollment& enrollment) {
  enroll_family<&orthogonal_polynomials::bending, &orthogonal_polynomials::torsion, 100, true>(
      enrollment, "orthogonal-polynomials", "Polynomials orthogonal over the length, clamped at the root");
}

}  // namespace withy
