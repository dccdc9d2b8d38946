/// \file
/// The multi-blade transform (Coleman & Feingold 1958): equal blades seen from where the rotor does not turn.
#pragma once

#include <string>
#include <vector>

#include "withy/core/analysis/turning_form.hpp"

namespace withy {

/// Equal parts of a rotor in the order in which they pass an angle: blade k + 1 comes where blade k is after 1/count of
/// a turn.
struct Blades {
  std::vector<std::vector<Eigen::Index>> speeds;  ///< of each blade, in one order
  std::vector<std::string> names;                 ///< of each blade: its first body
  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(speeds.size()); }
};

/// Sub-trees that could be blades: of the same parent, their bodies alike in kinds of hinges and names of modes; groups
/// of three to eight. \param names of their first bodies, or of the hinges these hang on; empty: every such group.
/// \throws std::invalid_argument where the bodies named are unknown or not alike.
std::vector<Blades> equal_branches(const Model& model, const std::vector<std::string>& names);

/// A coordinate of the multi-blade transform.
struct MultibladeCoordinate {
  enum class Kind { fixed, collective, cosine, sine, differential };
  Kind kind = Kind::fixed;
  int order = 0;              ///< n of cos nψ, sin nψ
  std::string name;           ///< of the first blade's speed, or of the speed that is not a blade's
  Eigen::Index partner = -1;  ///< of a cosine its sine, and the reverse
};

/// A in coordinates that do not turn: with angles ψ_k = ψ + 2π k/B of B blades,
///   q_k = a₀ + Σ_n (a_nc cos nψ_k + a_ns sin nψ_k) + a_d (−1)^k,   n below B/2, a_d where B is even,
/// for every coordinate and every speed of the blades; other coordinates stay as they are. With w = T⁻¹ z, z of A:
/// ẇ = T⁻¹ (A T − Ṫ) w, which has the characteristic exponents of A.
struct MultibladeForm {
  PeriodicMatrix A;  ///< constant where support and rotor are alike in all directions, or the blades see no weight
  Eigen::VectorXd masses;                         ///< of the new coordinates
  std::vector<MultibladeCoordinate> coordinates;  ///< of displacements, then of the states of loads
  Blades blades;                                  ///< in their order
};

/// Orders the blades so that A over 1/B of a turn is A with the blades exchanged, and transforms it.
/// \param form its period is one turn of the rotor; continuous states of loads stay as they are
/// \param state_names of these
/// \throws std::domain_error where no order does: the blades are not equal, or not equally spaced, or do not turn.
MultibladeForm multiblade_form(const TurningForm& form, const Held& held, const std::vector<std::string>& speed_names,
                               const std::vector<std::string>& state_names, const Blades& branches);

/// The modes of a constant first-order form: eigenvalues λ with Im λ ≥ 0, in the order of |λ|.
/// Shapes are of the displacements, then of the states of loads, which A may have rows for; what dominates is then what
/// takes part most.
std::vector<CharacteristicMode> constant_modes(const Eigen::MatrixXd& A, const Eigen::VectorXd& masses);

/// What dominates a mode: "blade1.bending_z[1] forward" (the pattern runs around with the rotor), "… backward", "…
/// collective", "… standing" where it does neither, or the name of a coordinate that is no blade's.
std::string pattern(const MultibladeForm& form, const CharacteristicMode& mode);

}  // namespace withy
