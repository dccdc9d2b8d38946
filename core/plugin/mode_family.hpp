/// \file
/// The interface of assumed-mode families.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace withy {

class Value;
struct MakeContext;

/// What a family may know of the beam whose strain it describes.
struct BeamData {
  /// `elongation` is of the axis: along it, extension, or across, shear.
  enum class Strain { bending, torsion, elongation };
  Strain strain = Strain::bending;
  double length = 0;     ///< [m]
  double inertia = 0;    ///< mass per length [kg/m], or in torsion polar inertia per length ρI_p [kg m]; its mean
  double stiffness = 0;  ///< EI, GJ [N m²], or EA, kGA [N]; its mean
  /// The same of one section.
  struct Section {
    double inertia = 0, stiffness = 0;
  };
  /// The section at x [m], where they vary along the beam; empty: they do not. Of a twisted beam about the section's
  /// own axes.
  std::function<Section(double x)> section = {};
  std::vector<double> kinks = {};  ///< where `section` may have kinks [m], in any order
};

/// Shape functions φ_i(x), i = 0 … count−1, 0 ≤ x ≤ L: deflections normalized ∫₀ᴸ φ_i² dx = L, twists and
/// elongations, which have the same functions, of amplitude 1, where the family does not give its coordinates another
/// meaning (as craig-bampton does). What an end of the beam does not do, it does not do beyond 1e-12: otherwise a
/// clamped root counts as moving.
class ShapeFunctions {
 public:
  virtual ~ShapeFunctions() = default;
  [[nodiscard]] virtual std::size_t count() const = 0;
  /// Greatest wave number β [1/m] among the functions: bodies choose their quadrature by it. At most most_waves / L.
  [[nodiscard]] virtual double wave_number() const = 0;
  /// Where a strain, φ″ in bending and else φ′, may have a kink or a step, between 0 and L, increasing.
  [[nodiscard]] virtual std::vector<double> kinks() const { return {}; }
  /// φ_i, φ_i′ [1/m] and φ_i″ [1/m²] of every function at x [m]; each span has count() elements.
  virtual void evaluate(double x, std::span<double> phi, std::span<double> slope,
                        std::span<double> curvature) const = 0;
};

/// A family of assumed modes, as "clamped-free".
class ModeFamily {
 public:
  virtual ~ModeFamily() = default;
  /// Greatest number of functions the family gives to stated accuracy.
  [[nodiscard]] virtual std::size_t most() const = 0;
  /// Whether enough of its functions describe any bending of a beam that is clamped at its root and free at its tip:
  /// studies may take one such family in place of another.
  [[nodiscard]] virtual bool spans_cantilevers() const { return false; }
  /// `count` ≤ most() functions of the beam, the first of them the same however many are asked for; null where the
  /// family has none for this strain.
  [[nodiscard]] virtual std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const = 0;
};

/// What is wrong with the functions that a family gives where `count` are asked for, or empty: another number of them,
/// a wave number that is none or beyond most_waves / L, kinks that do not increase from 0 to L, numbers that are not
/// finite, and slopes, in bending curvatures too, that are not the derivatives. These are compared at four places with
/// differences over steps of 1e-2 of 1/β and less, to 1e-4 of the greatest; where these do not tell (false_slope.hpp),
/// as at a kink, nothing is said.
std::string find_fault(const ShapeFunctions& functions, const BeamData& beam, std::size_t count);

/// The family that a scene's checked `family` names, as in make_shape_functions(). Null after reporting.
std::unique_ptr<ModeFamily> make_mode_family(const Value& family, const MakeContext& context);

/// The first `count` functions of the family that a scene's checked `family` names, either as `clamped-free` or with
/// its options as `{name: clamped-loaded, tip_mass: 2}` (a parameter `naming(ParameterSpec::Refers::mode_family)`).
/// Null after reporting, at the value's place, that there is no such family, that it gives fewer, none for this strain,
/// or some that have a fault.
std::unique_ptr<ShapeFunctions> make_shape_functions(const Value& family, const Value& count, const BeamData& beam,
                                                     const MakeContext& context);

}  // namespace withy
