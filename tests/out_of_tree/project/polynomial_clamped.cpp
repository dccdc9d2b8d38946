/// \file
/// Orthogonal polynomials that fit a clamped root, with ξ = x/L: for any distribution of mass and stiffness they come
/// closer to the true modes with each one more, and their integrals are exact.
///
/// Bending, φ(0) = φ′(0) = 0: ξ² times a polynomial. ∫ φ_i φ_j = L δ_ij asks for polynomials orthogonal with weight ξ⁴
/// on [0, 1], which are those of Jacobi:  φ_i = √(2i + 5) ξ² P_i^(0,4)(2ξ − 1),  i = 0, 1, …
/// Torsion, φ(0) = 0, weight ξ²:  φ_i = ξ P_i^(0,2)(2ξ − 1). These are elements of rotation matrices (Wigner's d), so
/// none exceeds 1, which all reach at the tip: the amplitude asked for.
#include <boost/math/special_functions/jacobi.hpp>
#include <cmath>
#include <withy/core/plugin/entry.hpp>
#include <withy/core/plugin/mode_family.hpp>

namespace {

using withy::BeamData;

class Polynomials final : public withy::ShapeFunctions {
 public:
  /// `power`: that of ξ; 2 for bending, 1 for torsion.
  Polynomials(double length, std::size_t count, double power) : length_(length), count_(count), power_(power) {}
  std::size_t count() const override { return count_; }
  /// In the middle of the beam P_i^(0,2·power) runs like cos((i + power + ½) acos(2ξ − 1)), where acos falls by 2 a
  /// unit of ξ.
  double wave_number() const override { return (2 * static_cast<double>(count_) - 1 + 2 * power_) / length_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    const double xi = x / length_;
    const double z = 2 * xi - 1;
    const double beta = 2 * power_;
    // ξ^power and its derivatives; the second is constant for both powers.
    const double a = std::pow(xi, power_);
    const double da = power_ == 2 ? 2 * xi : 1;
    const double dda = power_ == 2 ? 2 : 0;
    for (unsigned i = 0; i < count_; ++i) {
      const double scale = power_ == 2 ? std::sqrt(2 * i + 5.0) : 1;
      const double p = boost::math::jacobi(i, 0.0, beta, z);
      const double dp = 2 * boost::math::jacobi_prime(i, 0.0, beta, z);
      const double ddp = 4 * boost::math::jacobi_double_prime(i, 0.0, beta, z);
      phi[i] = scale * a * p;
      slope[i] = scale * (da * p + a * dp) / length_;
      curvature[i] = scale * (dda * p + 2 * da * dp + a * ddp) / (length_ * length_);
    }
  }

 private:
  double length_;
  std::size_t count_;
  double power_;
};

class PolynomialClamped final : public withy::ModeFamily {
 public:
  std::size_t most() const override { return 20; }
  std::unique_ptr<withy::ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    return std::make_unique<Polynomials>(beam.length, count, beam.strain == BeamData::Strain::bending ? 2 : 1);
  }
};

void enroll(withy::Enrollment& enrollment) {
  enrollment.add<withy::ModeFamily>(
      {.id = "polynomial-clamped",
       .summary = "Orthogonal polynomials clamped at the root, for beams of any section",
       .parameters = {},
       .make = [](const withy::Value&, const withy::MakeContext&) -> std::unique_ptr<withy::ModeFamily> {
         return std::make_unique<PolynomialClamped>();
       }});
}

}  // namespace

WITHY_PLUGIN(polynomial_clamped, enroll);
