#include "loaded_beam.hpp"

#include <boost/math/quadrature/gauss.hpp>

namespace withy {
namespace {

/// Below this β hyperbolic and circular functions cancel each other: power series take their place.
constexpr double slow = 1;

/// Σ_k ratio^k β^(4k+first)/(4k+first)!: eight terms leave nothing of it for β ≤ 1, |ratio| ≤ 4.
double quartic_series(double beta, int first, double ratio) {
  double term = 1;
  for (int i = 1; i <= first; ++i) term *= beta / i;
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    sum += term;
    term *= ratio;
    for (int i = 1; i <= 4; ++i) term *= beta / (4 * k + first + i);
  }
  return sum;
}

/// p = μβ, q = ςβ², r = ιβ³.
std::array<double, 3> tip_terms(const TipLoad& tip, double beta) {
  return {tip.mass * beta, tip.moment() * beta * beta, tip.inertia() * beta * beta * beta};
}

/// The characteristic function over cosh β, and what the number of its roots below β needs.
struct Characteristic {
  double value;         ///< F: the determinant of the tip's dynamic stiffness is F/held
  double held;          ///< 1/cosh β − cos β, whose roots are those of the beam with its tip clamped
  double displacement;  ///< the stiffness against displacement of the tip, times held/β³
};

/// F = sech β + cos β − p (sin β − tanh β cos β) − 2 q tanh β sin β − r (sin β + tanh β cos β)
///     + (p r − q²)(sech β − cos β).
Characteristic characteristic(const TipLoad& tip, double beta) {
  const auto [p, q, r] = tip_terms(tip, beta);
  const double sech = 1 / std::cosh(beta);
  const double tanh = std::tanh(beta);
  const double sine = std::sin(beta);
  const double cosine = std::cos(beta);
  double held = sech - cosine;
  double difference = sine - tanh * cosine;
  if (beta < slow) {
    held = 4 * sech * quartic_series(beta, 4, -4);        // 1 − cosh β cos β = −Σ_{k≥1} (−4)^k β^4k/(4k)!
    difference = 4 * sech * quartic_series(beta, 3, -4);  // sin β cosh β − cos β sinh β = ∫ 2 sin sinh
  }
  // p r − q² without the difference.
  const double determinant = p * tip.central_inertia * beta * beta * beta;
  const double value =
      sech + cosine - p * difference - 2 * q * tanh * sine - r * (sine + tanh * cosine) + determinant * held;
  return {value, held, sine + tanh * cosine - p * held};
}

/// Number of eigenvalues below β: those of the beam with its tip clamped, and the negative ones of the tip's 2×2
/// dynamic stiffness (Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263).
std::size_t roots_below(const TipLoad& tip, double beta) {
  const Characteristic c = characteristic(tip, beta);
  // The j-th root of `held` lies alone in (jπ, (j+1)π), j ≥ 1, where `held` has the sign −(−1)^j at first.
  const auto j = static_cast<std::size_t>(beta / boost::math::constants::pi<double>());
  std::size_t count = 0;
  if (j > 0) count = j - 1 + ((c.held > 0) == (j % 2 == 0) ? 1U : 0U);
  if (c.value * c.held < 0) return count + 1;
  return c.displacement * c.held < 0 ? count + 2 : count;
}

/// φ = u₁ − σ u₂ with u₁ = cosh βξ − cos βξ, u₂ = sinh βξ − sin βξ for a root β < slow, by power series.
class SlowWave {
 public:
  SlowWave(const TipLoad& tip, double beta) : beta_(beta) {
    const auto [p, q, r] = tip_terms(tip, beta);
    const auto u = derivatives(beta);
    const auto shear = [&, p = p, q = q](std::size_t i) { return u[(i + 1) % 4] + q * u[(i + 3) % 4] + p * u[i]; };
    const auto moment = [&, q = q, r = r](std::size_t i) { return u[(i + 2) % 4] - q * u[i] - r * u[(i + 3) % 4]; };
    // Derivatives run through u: u[i]′ = u[i−1]; u₁ is u[2], u₂ is u[3].
    const bool by_shear = std::abs(shear(3)) * (1 + std::abs(q) + r) > std::abs(moment(3)) * (1 + std::abs(q) + p);
    sigma_ = by_shear ? shear(2) / shear(3) : moment(2) / moment(3);
  }
  /// φ and its derivatives at ξ, for L = 1.
  std::array<double, 4> operator()(double xi) const {
    const auto u = derivatives(beta_ * xi);
    return {scale_ * (u[2] - sigma_ * u[3]), scale_ * beta_ * (u[1] - sigma_ * u[2]),
            scale_ * beta_ * beta_ * (u[0] - sigma_ * u[1]), scale_ * beta_ * beta_ * beta_ * (u[3] - sigma_ * u[0])};
  }
  double beta() const { return beta_; }
  void scale(double factor) { scale_ *= factor; }

 private:
  /// cosh + cos, sinh + sin, cosh − cos, sinh − sin: each the derivative of the next.
  static std::array<double, 4> derivatives(double x) {
    return {2 * quartic_series(x, 0, 1), 2 * quartic_series(x, 1, 1), 2 * quartic_series(x, 2, 1),
            2 * quartic_series(x, 3, 1)};
  }
  double beta_, sigma_ = 0, scale_ = 1;
};

/// The same for β ≥ slow, with decaying exponentials; h = ½ (σ − 1) exp β from the better of the tip's two conditions.
BeamWave fast_wave(const TipLoad& tip, double beta) {
  const auto [p, q, r] = tip_terms(tip, beta);
  const double e = std::exp(-beta), s = std::sin(beta), c = std::cos(beta);
  const double shear = 1 + e * e + 2 * e * c + q * (1 + e * e - 2 * e * c) + p * (1 - e * e - 2 * e * s);
  const double moment = 1 - e * e + 2 * e * s - q * (1 - e * e - 2 * e * s) - r * (1 + e * e - 2 * e * c);
  if (std::abs(shear) * (1 + std::abs(q) + r) > std::abs(moment) * (1 + std::abs(q) + p)) {
    return clamped_wave(beta, (-(e + s + c) + q * (s + c - e) + p * (e - c + s)) / shear);
  }
  return clamped_wave(beta, (e + c - s - q * (e - c + s) - r * (s + c - e)) / moment);
}

/// φ and φ′ of a wave at the tip, from what the wave has there: d^i = φ⁽ⁱ⁾/sⁱ, s = max(β, 1), of which each is
/// rounded in the last places of a wave of size one. A heavy body holds the tip: φ is the difference of numbers of size
/// one, but the shear that moves the body is not, and gives φ to all its digits. So the tip's motion x is where four
/// equations hold best, x = (d⁰, d¹) and P x = (−d³, d²), P the body's mass over that of the wave.
std::array<double, 2> tip_motion(const TipLoad& tip, double beta, const std::array<double, 4>& d) {
  const double s = std::max(beta, 1.0), b4 = beta * beta * beta * beta;
  const double p = b4 * tip.mass / (s * s * s), q = b4 * tip.moment() / (s * s), r = b4 * tip.inertia() / s;
  // Principal axes of P, (c, e) that of the greater value; the less without the difference that p r − q² is.
  const double span = std::hypot(p - r, 2 * q), turn = q == 0 ? 0 : 2 * q / (std::abs(p - r) + span);
  const double near = 1 / std::sqrt(1 + turn * turn), far = turn * near;
  const double c = p >= r ? near : far, e = p >= r ? far : near;
  const double most = 0.5 * (p + r + span);
  const double least = most > 0 ? p * (b4 * tip.central_inertia / s) / most : 0;
  const auto along = [&](double value, double x, double force) { return (x + value * force) / (1 + value * value); };
  const double first = along(most, c * d[0] + e * d[1], e * d[2] - c * d[3]);
  const double second = along(least, c * d[1] - e * d[0], c * d[2] + e * d[3]);
  return {c * first - e * second, s * (e * first + c * second)};
}

/// ∫₀¹ φ² dξ, for a wave of this β.
template <class Phi>
double norm(double beta, Phi phi) {
  const int panels = 1 + static_cast<int>(beta / 4);
  double sum = 0;
  for (int i = 0; i < panels; ++i) {
    sum += boost::math::quadrature::gauss<double, 20>::integrate(
        [&](double xi) {
          const double value = phi(xi);
          return value * value;
        },
        static_cast<double>(i) / panels, static_cast<double>(i + 1) / panels);
  }
  return sum;
}

class LoadedBeam final : public ShapeFunctions {
 public:
  LoadedBeam(double length, const TipLoad& tip, std::size_t count) : length_(length), count_(count) {
    std::vector<BeamWave> waves;
    for (std::size_t k = 1; k <= count; ++k) {
      const double beta = loaded_beam_root(tip, k);
      last_ = beta / length;
      if (beta < slow) {
        SlowWave& wave = slow_.emplace_back(tip, beta);
        wave.scale(1 / (beta * beta));  // of size one near the tip
        wave.scale(1 / std::sqrt(norm(beta, [&](double xi) { return wave(xi)[0]; })));
        tips_.push_back(tip_motion(tip, beta, wave(1)));
      } else {
        const BeamWave w = waves.emplace_back(normalized(fast_wave(tip, beta)));
        const double sine = w.cosine * std::cos(beta) + w.sine * std::sin(beta);
        const double cosine = w.sine * std::cos(beta) - w.cosine * std::sin(beta), root = w.root * std::exp(-beta);
        tips_.push_back(tip_motion(
            tip, beta, {sine + root + w.tip, cosine - root + w.tip, -sine + root + w.tip, -cosine - root + w.tip}));
      }
    }
    if (!waves.empty()) {
      fast_ = std::make_unique<BeamWaves>(length, EndCondition::clamped, EndCondition::loaded, std::move(waves));
    }
  }
  std::size_t count() const override { return count_; }
  double wave_number() const override { return last_; }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    for (std::size_t k = 0; k < slow_.size(); ++k) {
      const auto [value, first, second, third] = slow_[k](x / length_);
      phi[k] = value;
      slope[k] = first / length_;
      curvature[k] = second / (length_ * length_);
    }
    const std::size_t n = slow_.size();
    if (fast_) fast_->evaluate(x, phi.subspan(n), slope.subspan(n), curvature.subspan(n));
    if (x != length_) return;
    for (std::size_t k = 0; k < count_; ++k) {
      phi[k] = tips_[k][0];
      slope[k] = tips_[k][1] / length_;
    }
  }

 private:
  static BeamWave normalized(BeamWave w) {
    const double scale = 1 / std::sqrt(norm(w.beta, [&](double xi) {
                           return w.cosine * std::cos(w.beta * xi) + w.sine * std::sin(w.beta * xi) +
                                  w.root * std::exp(-w.beta * xi) + w.tip * std::exp(-w.beta * (1 - xi));
                         }));
    return {w.beta, scale * w.cosine, scale * w.sine, scale * w.root, scale * w.tip};
  }

  double length_;
  std::size_t count_;
  double last_ = 0;
  std::vector<SlowWave> slow_;
  std::unique_ptr<BeamWaves> fast_;
  std::vector<std::array<double, 2>> tips_;  ///< φ, dφ/dξ at the tip
};

}  // namespace

double loaded_beam_root(const TipLoad& tip, std::size_t k) {
  // A load lowers the roots of the clamped-free beam, which are below kπ.
  const double top = beam_roots::half_waves(k, 0.0);
  const auto side = [&](double beta) { return roots_below(tip, beta) < k ? -1.0 : 1.0; };
  // Logarithmic steps at the lower end: a heavy tip makes the first roots small.
  double low = top;
  while (side(low) > 0) low /= 2;
  return beam_roots::between(low, 2 * low, side);
}

std::unique_ptr<ShapeFunctions> loaded_beam(double length, const TipLoad& tip, std::size_t count) {
  return std::make_unique<LoadedBeam>(length, tip, count);
}

}  // namespace withy
