/// \file
/// A slender beam along x from `root` (x = 0) to `tip` (x = length) that bends along y. Its section is a rectangle of
/// constant width whose depth falls linearly, h(x) = h₀ (1 − (1 − taper) x/L): mass per length goes with h, stiffness
/// EI with h³.
///
/// Kinematics, second order in the modal coordinates q, for deflections v = Σ φ_i(x) q_i of an inextensible beam:
///   r = (x − ½ ∫₀ˣ v′² dσ, v, 0), rotation v′ about z  →  Φ_y = φ, Ψ_z = φ′, Γ_x = −∫₀ˣ φ′ φ′ᵀ dσ.
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <span>
#include <withy/core/plugin/mode_family.hpp>

#include "bodies.hpp"

namespace example {
namespace {

using withy::PointExpansion;

/// Calls f(x, weight) at Gauss points of [0, end]: panels of 20 points, each at most 2.5 of the functions' wave-number
/// lengths long, integrate products of two functions to rounding.
template <class Function>
void integrate(double end, double wave_number, const Function& f) {
  using Gauss = boost::math::quadrature::gauss<double, 20>;
  const double panels = std::max(1.0, std::ceil(wave_number * end / 2.5));
  const double half = end / panels / 2;
  for (double center = half; center < end; center += 2 * half) {
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
      f(center - half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
      f(center + half * Gauss::abscissa()[i], half * Gauss::weights()[i]);
    }
  }
}

class TaperedBeam final : public withy::Body {
 public:
  struct Data {
    double length, mass_per_length, stiffness, taper, damping_ratio;
  };

  TaperedBeam(const Data& data, std::unique_ptr<withy::ShapeFunctions> functions)
      : data_(data), functions_(std::move(functions)), n_(static_cast<Eigen::Index>(functions_->count())) {
    shape_.length = data.length;
    for (Eigen::Index i = 1; i <= n_; ++i) shape_.mode_names.push_back("bending_y[" + std::to_string(i) + "]");
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(n_, n_);
    Eigen::VectorXd modal_mass = Eigen::VectorXd::Zero(n_);
    integrate(data.length, functions_->wave_number(), [&](double x, double weight) {
      const double depth = 1 - (1 - data.taper) * x / data.length;
      const double mass = weight * data.mass_per_length * depth;
      const Fields f = fields(x);
      shape_.particles.push_back({mass, expansion(x)});
      shape_.stiffness += weight * data.stiffness * std::pow(depth, 3) * f.curvature * f.curvature.transpose();
      modal_mass += mass * f.phi.cwiseAbs2();
    });
    for (Eigen::Index i = 0; i < n_; ++i) {
      shape_.damping(i, i) = 2 * data.damping_ratio * std::sqrt(shape_.stiffness(i, i) * modal_mass[i]);
    }
  }
  const withy::ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override {
    if (name == StationName("root")) return expansion(0);
    if (name == StationName("tip")) return expansion(data_.length);
    const double* x = std::get_if<double>(&name);
    if (x == nullptr || !(*x >= 0 && *x <= data_.length)) return {};
    return expansion(*x);
  }
  std::string stations() const override {
    return "root, tip, or a coordinate x from 0 to " + std::to_string(data_.length) + " m";
  }

 private:
  struct Fields {
    Eigen::VectorXd phi, slope, curvature;
  };
  Fields fields(double x) const {
    Fields f{Eigen::VectorXd(n_), Eigen::VectorXd(n_), Eigen::VectorXd(n_)};
    const auto view = [](Eigen::VectorXd& v) { return std::span(v.data(), static_cast<std::size_t>(v.size())); };
    functions_->evaluate(x, view(f.phi), view(f.slope), view(f.curvature));
    return f;
  }
  PointExpansion expansion(double x) const {
    PointExpansion e = PointExpansion::rigid({x, 0, 0}, n_);
    const Fields f = fields(x);
    e.phi.row(1) = f.phi.transpose();
    e.psi.row(2) = f.slope.transpose();
    integrate(x, functions_->wave_number(), [&](double s, double weight) {
      const Eigen::VectorXd slope = fields(s).slope;
      e.gamma[0] -= weight * slope * slope.transpose();
    });
    return e;
  }

  Data data_;
  std::unique_ptr<withy::ShapeFunctions> functions_;
  Eigen::Index n_;
  withy::ModalShape shape_;
};

std::unique_ptr<withy::Body> make_tapered_beam(const withy::Value& p, const withy::MakeContext& context) {
  const TaperedBeam::Data data = {p.number_at("length"), p.number_at("mass_per_length"), p.number_at("stiffness"),
                                  p.number_at("taper"), p.number_at("damping_ratio")};
  // A family is another plugin, found by its id: one of withy's own, or anybody's.
  auto functions = withy::make_shape_functions(
      p.at("family"), p.at("modes"),
      {withy::BeamData::Strain::bending, data.length, data.mass_per_length, data.stiffness}, context);
  if (functions == nullptr) return nullptr;
  return std::make_unique<TaperedBeam>(data, std::move(functions));
}

}  // namespace

withy::Plugin<withy::Body> tapered_beam() {
  using withy::number;
  return {
      .id = "tapered-beam",
      .summary = "Slender beam along x of linearly falling depth, bending along y",
      .parameters = {number("length", "m", "length, undeformed").above(0),
                     number("mass_per_length", "kg/m", "mass per length at the root").above(0),
                     number("stiffness", "N m^2", "EI_z at the root").above(0),
                     number("taper", "1", "depth at the tip over depth at the root").above(0).most(1).otherwise(1.0),
                     withy::integer("modes", "number of assumed modes")
                         .least(1)
                         .otherwise(2.0)
                         .as(withy::ParameterSpec::Role::modes),
                     withy::text("family", "assumed-mode family")
                         .naming(withy::ParameterSpec::Refers::mode_family)
                         .otherwise("clamped-free")
                         .as(withy::ParameterSpec::Role::bending_family),
                     number("damping_ratio", "1", "modal damping, as a fraction of critical").least(0).otherwise(0.0)},
      .make = &make_tapered_beam};
}

}  // namespace example
