/// \file
/// The equations of motion taken apart into the groups of terms that formulations keep or drop.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Groups of terms, in the order of the ledger. With M = M⁰ + M*¹ + M*² + M*³,
///   M u̇ + K q + D q̇ = f₁ + f₂¹ + f₂² + f₃ + weight + weight*¹ + weight*² + weight*³ + loads + loads*¹ + loads*² +
///   loads*³.
/// Index 1 of f: of order zero in the elastic coordinates; 2: of order one, from linear (¹) and from nonlinear (²)
/// relations of strain and displacement; 3: all that is of higher order. Stars count as those of M.
enum class Term {
  inertia,             ///< M⁰ u̇
  inertia_linear,      ///< M*¹ u̇
  inertia_quadratic,   ///< M*² u̇
  inertia_higher,      ///< M*³ u̇, without which M need not be positive definite
  velocity_rigid,      ///< f₁
  velocity_linear,     ///< f₂¹
  velocity_quadratic,  ///< f₂²
  velocity_higher,     ///< f₃
  weight,              ///< of order zero
  weight_linear,       ///< where linear relations move what is heavy
  weight_quadratic,    ///< where foreshortening does: what buckles a column
  weight_higher,       ///< of higher order
  stiffness,           ///< K q
  damping,             ///< D q̇
  loads,               ///< of order zero, and the efforts of prescribed motions
  loads_linear,        ///< where linear relations move the frames that loads act at, and turn what follows them
  loads_quadratic,     ///< where foreshortening moves them: what buckles a column under a force at its tip
  loads_higher         ///< of higher order
};
inline constexpr std::size_t terms_of_motion = 18;
/// "M0 a", "M*1 a", …, "f1", "f2-1", "f2-2", "f3", "weight", "weight*1", …, "K q", "D q'", "loads", "loads*1", ….
std::string_view name(Term term);

/// The terms at one state: for each a force on every generalized speed [N m, N].
using TermForces = std::array<std::vector<double>, terms_of_motion>;

class TermLedger {
 public:
  /// Equations of one model in the four formulations whose differences are the groups.
  struct Formulations {
    const EquationsOfMotion* ruthless;
    const EquationsOfMotion* inconsistent;
    const EquationsOfMotion* consistent;
    const EquationsOfMotion* quadratic;
  };
  /// What the formulations point to, and the model, must outlive the ledger.
  TermLedger(const Model& model, const Formulations& formulations) : model_(model), of_(formulations) {}
  /// At a state with the accelerations u_dot of all generalized speeds, whoever computed them.
  [[nodiscard]] TermForces evaluate(const State& state, std::span<const double> u_dot) const;

 private:
  const Model& model_;
  Formulations of_;
};

/// M u̇ − f [N m, N] of the equations at a state, loads included: what motions, and errors, are left to account for.
std::vector<double> force_balance(const EquationsOfMotion& equations, const State& state,
                                  std::span<const double> u_dot);

/// Coordinates that are looked at together: "hinges", "bending", "torsion", and "elastic" for other modes.
struct CoordinateGroup {
  std::string name;
  std::vector<std::size_t> speeds;
};
std::vector<CoordinateGroup> coordinate_groups(const Layout& layout);

/// √(Σ F_i² / m_i) over a group, m_i the inertia of coordinate i: of one unit, N/√kg, whatever the coordinates are.
double size_of(const std::vector<double>& forces, const CoordinateGroup& group, const std::vector<double>& inertias);

}  // namespace withy
