/// \file
/// Eigenfunctions of the uniform beam that is clamped at the root and carries a rigid body at its tip: loaded_beam.hpp
/// in bending, ∫₀ᴸ φ² dx = L; sin βx/L with β tan β = ρI_p L/J in torsion, of amplitude 1, J the tip body's inertia
/// about the beam's axis; in extension and shear the same with masses. They are orthogonal with respect to the mass of
/// beam and tip body, so that one of them gives a loaded cantilever's first frequency exactly, where clamped-free
/// functions need many.
#include <algorithm>
#include <stdexcept>

#include "loaded_beam.hpp"
#include "uniform_rod.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// Beyond this ratio of tip body to beam the first roots of the characteristic equation have no digits to spare.
constexpr double most_load = 1e10;

/// Roots of cos β = ι β sin β, one in each (kπ − π, kπ).
double rod_root(double inertia, std::size_t k) {
  const double top = beam_roots::half_waves(k, 0.0);
  return beam_roots::between(top - boost::math::constants::pi<double>(), top,
                             [&](double b) { return std::cos(b) - inertia * b * std::sin(b); });
}

/// sin βξ, at the tip by what moves the load there too, as loaded_beam.hpp has it in bending: of a heavy load φ(L) is
/// next to nothing, but φ′(L) = ι β² φ(L) is not.
class LoadedRod final : public ShapeFunctions {
 public:
  LoadedRod(double length, double inertia, std::vector<double> betas)
      : length_(length), waves_(length, RodWaves::Root::clamped, betas) {
    for (const double b : betas) {
      const double p = inertia * b;
      tips_.push_back((std::sin(b) + p * std::cos(b)) / (1 + p * p));
    }
  }
  std::size_t count() const override { return waves_.count(); }
  double wave_number() const override { return waves_.wave_number(); }
  void evaluate(double x, std::span<double> phi, std::span<double> slope, std::span<double> curvature) const override {
    waves_.evaluate(x, phi, slope, curvature);
    if (x == length_) std::copy(tips_.begin(), tips_.end(), phi.begin());
  }

 private:
  double length_;
  RodWaves waves_;
  std::vector<double> tips_;  ///< φ(L)
};

class ClampedLoaded final : public ModeFamily {
 public:
  ClampedLoaded(double mass, double inertia, double offset) : mass_(mass), inertia_(inertia), offset_(offset) {}
  std::size_t most() const override { return 200; }
  bool spans_cantilevers() const override { return true; }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    const double L = beam.length;
    if (beam.strain != BeamData::Strain::bending) {
      const double ratio = (beam.strain == BeamData::Strain::torsion ? inertia_ : mass_) / (beam.inertia * L);
      check(ratio);
      std::vector<double> betas;
      for (std::size_t k = 1; k <= count; ++k) betas.push_back(rod_root(ratio, k));
      return std::make_unique<LoadedRod>(L, ratio, std::move(betas));
    }
    const double mass = beam.inertia * L;
    const TipLoad tip = {mass_ / mass, offset_ / L, inertia_ / (mass * L * L)};
    check(tip.mass);
    check(tip.inertia());
    return loaded_beam(L, tip, count);
  }

 private:
  static void check(double ratio) {
    if (!(ratio <= most_load)) {
      throw std::invalid_argument("clamped-loaded: the tip body has " + std::to_string(ratio) +
                                  " times the beam's inertia; need at most " + std::to_string(most_load));
    }
  }
  double mass_, inertia_, offset_;
};

std::unique_ptr<ModeFamily> make_clamped_loaded(const Value& p, const MakeContext& context) {
  if (!p.has("tip_mass") && !p.has("tip_inertia")) {
    context.diagnostics.error(
        p.place(),
        "clamped-loaded: got no load at the tip; need tip_mass, tip_inertia or both (clamped-free has none)");
    return nullptr;
  }
  const auto given = [&](const char* key) { return p.has(key) ? p.number_at(key) : 0.0; };
  return std::make_unique<ClampedLoaded>(given("tip_mass"), given("tip_inertia"), p.number_at("tip_offset"));
}

}  // namespace

void enroll_clamped_loaded(Enrollment& enrollment) {
  enrollment.add<ModeFamily>(
      {.id = "clamped-loaded",
       .summary = "Eigenfunctions of the uniform beam clamped at the root that carries a rigid body at its tip",
       .parameters =
           {number("tip_mass", "kg", "mass of the tip body").least(0).optional(),
            number("tip_inertia", "kg m^2",
                   "its inertia about the bending axis through its centre of mass; in torsion about the beam")
                .least(0)
                .optional(),
            number("tip_offset", "m", "distance of its centre of mass beyond the tip, along the beam").otherwise(0.0)},
       .make = &make_clamped_loaded});
}

}  // namespace withy
