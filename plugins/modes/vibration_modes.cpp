/// \file
/// Vibration modes of a beam as it is: clamped at the root, of varying section, with a rigid body at its tip; and
/// behind them static shapes of the tip.
///
/// Moments are polynomials p_j(x), strains p_j/EI: kinks and steps of the stiffness are then in the strains, where
/// those of the beam are, and a smooth moment takes few functions. With the p_j orthonormal in energy, ∫ p_i p_j/EI dx
/// = δ_ij, and φ_j their deflections, Ritz's equations are
///   A v = λ v,  A_ij = ∫ μ φ_i φ_j dx + m d_i d_j + J φ_i′ φ_j′ (at L),  d = φ + a φ′,  λ = 1/ω²,
/// whose greatest eigenvalues, the lowest frequencies, are the best known. A static shape is the deflection under a
/// force or moment at the tip, whose moment is a polynomial too, without the part that modes have: MacNeal's residual
/// flexibility (R. H. MacNeal, A hybrid method of component mode synthesis, Computers & Structures 1, 1971; S. Rubin,
/// Improved component-mode representation for structural dynamic analysis, AIAA Journal 13, 1975). It is orthogonal to
/// the modes in mass and stiffness, as they are to each other.
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "panel_functions.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/shape/panel_quadrature.hpp"

namespace withy {
namespace vibration_modes {

using Strain = BeamData::Strain;
using Section = BeamData::Section;

/// Of a beam's own inertia: a load that is greater leaves λ of the second mode no digits beside the first. Its shapes
/// differ by as little from those of a load like this.
constexpr double most_load = 1e6;
/// A panel's stiffness changes by this factor at most, where it is linear: 1/EI is then a polynomial of degree 15 there
/// to 1e-12.
constexpr double most_change = 2;
/// Radians of the shortest wave that a panel of a body's quadrature spans: where waves are shorter than elsewhere, as
/// towards a slender tip, the wave number is that of what such a panel holds there.
constexpr double panel_phase = 2.5;

struct TipBody {
  double mass = 0;             ///< [kg]
  double central_inertia = 0;  ///< [kg m²]
  double offset = 0;           ///< [m]
};

Section section_at(const BeamData& beam, double x) {
  return beam.section ? beam.section(x) : Section{beam.inertia, beam.stiffness};
}

/// Kinks inside the beam, increasing.
std::vector<double> inner_kinks(const BeamData& beam) {
  std::vector<double> x = beam.kinks;
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  std::erase_if(x, [&](double at) { return at <= 0 || at >= beam.length; });
  return x;
}

/// Appends the end of a panel, or of its halves where stiffness changes too much in it.
void append(const BeamData& beam, double from, double to, std::vector<double>& edges) {
  const double a = section_at(beam, from).stiffness, b = section_at(beam, to).stiffness;
  if (std::max(a, b) > most_change * std::min(a, b) && to - from > 1e-9 * beam.length) {
    append(beam, from, 0.5 * (from + to), edges);
    append(beam, 0.5 * (from + to), to, edges);
  } else {
    edges.push_back(to);
  }
}

std::vector<double> panel_edges(const BeamData& beam, const std::vector<double>& kinks, double longest) {
  std::vector<double> edges{0}, ends = kinks;
  ends.push_back(beam.length);
  for (const double end : ends) {
    const double from = edges.back(), parts = std::ceil((end - from) / longest);
    for (double k = 1; k <= parts; ++k)
      append(beam, edges.back(), k == parts ? end : from + (end - from) * k / parts, edges);
  }
  return edges;
}

/// P_0 … P_(count−1) of Legendre at x of [0, length], a row each x.
Eigen::MatrixXd legendre(const std::vector<double>& x, double length, Eigen::Index count) {
  Eigen::MatrixXd P(static_cast<Eigen::Index>(x.size()), count);
  for (Eigen::Index r = 0; r < P.rows(); ++r) {
    const double s = 2 * x[static_cast<std::size_t>(r)] / length - 1;
    P(r, 0) = 1;
    if (count > 1) P(r, 1) = s;
    for (Eigen::Index k = 1; k + 1 < count; ++k) {
      const auto n = static_cast<double>(k);
      P(r, k + 1) = ((2 * n + 1) * s * P(r, k) - n * P(r, k - 1)) / (n + 1);
    }
  }
  return P;
}

/// Some functions at the nodes, a column each, and at the tip.
struct Deflections {
  Eigen::MatrixXd phi;
  Eigen::RowVectorXd tip, tip_slope;
};

/// Functions are columns E of values at the nodes, √(w/EI) M with M the moment of each (of a rod the force or torque),
/// so that Eᵀ E is their energy.
class Ritz {
 public:
  Ritz(const BeamData& beam, const TipBody& tip, Eigen::Index count)
      : beam_(beam),
        tip_(tip),
        kinks_(inner_kinks(beam)),
        // Polynomials of degree d go like cos 2dx/L amid the beam: a panel spans 4 of that.
        edges_(panel_edges(beam, kinks_, 2 * beam.length / static_cast<double>(polynomials(count)))),
        quadrature_(edges_, PanelFunctions::order) {
    const auto& x = quadrature_.nodes();
    const auto nodes = static_cast<Eigen::Index>(x.size());
    root_.resize(nodes), stiffness_.resize(nodes), inertia_.resize(nodes);
    weights_ = Eigen::Map<const Eigen::VectorXd>(quadrature_.weights().data(), nodes);
    x_ = Eigen::Map<const Eigen::VectorXd>(x.data(), nodes);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      const Section s = section_at(beam, x_[k]);
      stiffness_[k] = s.stiffness, inertia_[k] = s.inertia;
      root_[k] = std::sqrt(weights_[k] / s.stiffness);
    }
    solve(count);
  }

  /// The functions: modes, and behind them so many static shapes.
  [[nodiscard]] std::unique_ptr<ShapeFunctions> functions(Eigen::Index count, Eigen::Index shapes) const {
    Eigen::MatrixXd E(x_.size(), count);
    E.leftCols(count - shapes) = modes_.leftCols(count - shapes);
    if (shapes > 0) E.rightCols(shapes) = residuals(E.leftCols(count - shapes), shapes);
    Eigen::MatrixXd strains = strains_of(E);
    const Deflections d = deflections(strains);
    const double least = inertia_of(d).diagonal().minCoeff();  // λ
    for (Eigen::Index i = 0; i < count; ++i) {
      const double square = weights_.dot(d.phi.col(i).cwiseAbs2()) / beam_.length;
      const double size = std::sqrt(bends() ? square : 2 * square);
      strains.col(i) *= (strains(0, i) < 0 ? -1 : 1) / size;
    }
    return std::make_unique<PanelFunctions>(beam_.strain, edges_, strains, wave_number(least), kinks_);
  }

 private:
  [[nodiscard]] bool bends() const { return beam_.strain == Strain::bending; }

  /// Enough for so many functions of an even beam.
  static Eigen::Index polynomials(Eigen::Index count) { return 30 + 3 * count; }

  [[nodiscard]] Eigen::MatrixXd strains_of(const Eigen::MatrixXd& E) const {
    return root_.cwiseProduct(stiffness_).cwiseInverse().asDiagonal() * E;
  }
  [[nodiscard]] static Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& E) {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(E).householderQ() * Eigen::MatrixXd::Identity(E.rows(), E.cols());
  }

  [[nodiscard]] Deflections deflections(const Eigen::MatrixXd& strains) const {
    const Eigen::MatrixXd once = quadrature_.running_integral(strains);
    const Eigen::RowVectorXd once_tip = weights_.transpose() * strains;
    if (!bends()) return {once, once_tip, {}};
    return {quadrature_.running_integral(once), weights_.transpose() * once, once_tip};
  }

  /// A of functions.
  [[nodiscard]] Eigen::MatrixXd inertia_of(const Deflections& d) const {
    Eigen::MatrixXd A = d.phi.transpose() * weights_.cwiseProduct(inertia_).asDiagonal() * d.phi;
    if (!bends()) return A + tip_inertia() * d.tip.transpose() * d.tip;
    const Eigen::RowVectorXd centre = d.tip + tip_.offset * d.tip_slope;
    return A + tip_.mass * centre.transpose() * centre + tip_.central_inertia * d.tip_slope.transpose() * d.tip_slope;
  }
  /// Of a rod, in its own direction.
  [[nodiscard]] double tip_inertia() const {
    return beam_.strain == Strain::torsion ? tip_.central_inertia : tip_.mass;
  }

  /// Moments of the inertia that deflections have, per ω²: ∫ₓᴸ μ φ (s − x) ds and that of the tip's body.
  [[nodiscard]] Eigen::MatrixXd moments_of(const Deflections& d) const {
    const auto beyond = [&](const Eigen::MatrixXd& values) -> Eigen::MatrixXd {
      return (-quadrature_.running_integral(values)).rowwise() + Eigen::RowVectorXd(weights_.transpose() * values);
    };
    const Eigen::MatrixXd force = beyond(inertia_.asDiagonal() * d.phi);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(x_.size());
    if (!bends()) return force + ones * (tip_inertia() * d.tip);
    const Eigen::VectorXd arm = (beam_.length + tip_.offset) * ones - x_;
    return beyond(force) + arm * (tip_.mass * (d.tip + tip_.offset * d.tip_slope)) +
           ones * (tip_.central_inertia * d.tip_slope);
  }

  /// Ritz's equations in polynomials, and then in the moments of what they find: kinks of the mass bend moments too,
  /// and polynomials bend to them slowly. Each time the share of others in a mode shrinks by their λ over its own.
  void solve(Eigen::Index count) {
    const int times = beam_.section ? 10 : 2;
    modes_ = root_.asDiagonal() * legendre(quadrature_.nodes(), beam_.length, polynomials(count));
    const Eigen::Index kept = 2 * count + 8;
    for (int time = 0; time <= times; ++time) {
      modes_ = orthonormal(modes_);
      const Deflections d = deflections(strains_of(modes_));
      const Eigen::MatrixXd turn = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(inertia_of(d))
                                       .eigenvectors()
                                       .rowwise()
                                       .reverse()
                                       .leftCols(std::min(kept, modes_.cols()));
      if (time == times) {
        modes_ = modes_ * turn;
      } else {
        modes_ = root_.asDiagonal() * (moments_of(d) * turn);
        modes_.colwise().normalize();
      }
    }
  }

  /// Static shapes of the tip without what these orthonormal ones have of them, orthogonal in mass too.
  [[nodiscard]] Eigen::MatrixXd residuals(const Eigen::MatrixXd& modes, Eigen::Index shapes) const {
    Eigen::MatrixXd moments = Eigen::MatrixXd::Ones(x_.size(), shapes);  // of a moment; of a rod a force or torque
    if (bends()) moments.col(0) -= x_ / beam_.length;
    Eigen::MatrixXd r = root_.asDiagonal() * moments;
    for (int twice = 0; twice < 2; ++twice) r -= modes * (modes.transpose() * r);
    r = orthonormal(r);
    const Eigen::MatrixXd A = inertia_of(deflections(strains_of(r)));
    return r * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvectors().rowwise().reverse();
  }

  /// The least wave number whose panels hold no more than panel_phase of waves with ω² = 1/λ.
  [[nodiscard]] double wave_number(double lambda) const {
    const auto local = [&](std::size_t k) {
      const auto n = static_cast<Eigen::Index>(k);
      const double square = inertia_[n] / (lambda * stiffness_[n]);  // of the wave number, in bending its fourth power
      return bends() ? std::sqrt(std::sqrt(square)) : std::sqrt(square);
    };
    std::vector<double> phase{0};
    for (std::size_t p = 0, k = 0; p + 1 < edges_.size(); ++p) {
      double sum = 0;
      for (Eigen::Index j = 0; j < PanelFunctions::order; ++j, ++k) sum += quadrature_.weights()[k] * local(k);
      phase.push_back(phase.back() + sum);
    }
    double least = phase.back() / beam_.length;
    while (greatest_phase(phase, panel_phase / least) > panel_phase * (1 + 1e-9)) least *= 1.02;
    return least;
  }

  /// In any piece of a length, of waves whose phase at the edges is given.
  [[nodiscard]] double greatest_phase(const std::vector<double>& phase, double length) const {
    const auto at = [&](double x) {
      const auto after = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, x);
      const auto p = static_cast<std::size_t>(after - edges_.begin());
      return phase[p - 1] + (phase[p] - phase[p - 1]) * (x - edges_[p - 1]) / (edges_[p] - edges_[p - 1]);
    };
    double greatest = 0;
    for (const double from : edges_) {
      greatest = std::max(greatest, at(std::min(from + length, beam_.length)) - at(from));
      greatest = std::max(greatest, at(from) - at(std::max(from - length, 0.0)));
    }
    return greatest;
  }

  const BeamData& beam_;
  const TipBody tip_;
  std::vector<double> kinks_, edges_;
  PanelQuadrature quadrature_;
  Eigen::VectorXd x_, weights_, stiffness_, inertia_, root_;  ///< at the nodes; root_ = √(w/EI)
  Eigen::MatrixXd modes_;
};

class VibrationModes final : public ModeFamily {
 public:
  VibrationModes(const TipBody& tip, std::size_t shapes) : tip_(tip), shapes_(shapes) {}
  std::size_t most() const override { return 60; }
  bool spans_cantilevers() const override { return true; }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    const std::size_t of_strain = beam.strain == Strain::bending ? shapes_ : std::min<std::size_t>(shapes_, 1);
    const auto shapes = static_cast<Eigen::Index>(std::min(of_strain, count - 1));
    const auto n = static_cast<Eigen::Index>(count);
    return Ritz(beam, within_reach(beam), n).functions(n, shapes);
  }

 private:
  /// The load, or one that gives the same shapes.
  [[nodiscard]] TipBody within_reach(const BeamData& beam) const {
    const double own = beam.inertia * beam.length, L = beam.length;
    if (beam.strain != Strain::bending)
      return {std::min(tip_.mass, most_load * own), std::min(tip_.central_inertia, most_load * own), 0};
    const double greatest =
        std::max({tip_.mass, (tip_.central_inertia + tip_.mass * tip_.offset * tip_.offset) / (L * L)});
    const double share = std::min(1.0, most_load * own / std::max(greatest, std::numeric_limits<double>::min()));
    return {share * tip_.mass, share * tip_.central_inertia, tip_.offset};
  }

  TipBody tip_;
  std::size_t shapes_;
};

std::unique_ptr<ModeFamily> make(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<VibrationModes>(
      TipBody{p.number_at("tip_mass"), p.number_at("tip_inertia"), p.number_at("tip_offset")}, p.count_at("static"));
}

}  // namespace vibration_modes

void enroll_vibration_modes(Enrollment& enrollment) {
  enrollment.add<ModeFamily>(
      {.id = "vibration-modes",
       .summary = "Vibration modes of the beam as it varies, with a body at its tip, and static shapes of the tip",
       .parameters =
           {number("tip_mass", "kg", "mass of the tip body").least(0).otherwise(0.0),
            number("tip_inertia", "kg m^2",
                   "its inertia about the bending axis through its centre of mass; in torsion about the beam")
                .least(0)
                .otherwise(0.0),
            number("tip_offset", "m", "distance of its centre of mass beyond the tip, along the beam").otherwise(0.0),
            integer("static",
                    "how many of several functions are static: deflections under a force and, in bending, a moment at "
                    "the tip, without what the modes have of them")
                .least(0)
                .most(2)
                .otherwise(1)},
       .make = &vibration_modes::make});
}

}  // namespace withy
