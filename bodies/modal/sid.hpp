/// \file
/// Standard Input Data of a flexible body (SID): what they hold, and their text form.
/// O. Wallrapp, "Standard Input Data of Flexible Members in Multibody Systems", in: Advanced Multibody System Dynamics,
/// Kluwer 1993, pp. 445–450; the meaning of each matrix follows R. Schwertassek and O. Wallrapp, "Dynamik flexibler
/// Mehrkörpersysteme", Vieweg 1999, eqs. (6.402)–(6.407).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace withy::sid {

/// A matrix to first order in the modal coordinates: M(q) = m0 + Σ m1[k] q_k. `m1` is empty where the order is 0.
struct Taylor {
  Eigen::MatrixXd m0;
  std::vector<Eigen::MatrixXd> m1;

  [[nodiscard]] bool absent() const { return m0.size() == 0; }
  /// Whether anything of first order is not zero.
  [[nodiscard]] bool varies() const {
    return std::any_of(m1.begin(), m1.end(), [](const Eigen::MatrixXd& m) { return !m.isZero(0); });
  }
};

/// A node of the frame list; all in the body's axes.
struct Node {
  std::string id;
  Taylor origin;  ///< position, 3×1 [m]
  Taylor phi;     ///< ∂(velocity)/∂q̇, 3×n; its first order is Γ
  Taylor psi;     ///< ∂(angular velocity)/∂q̇, 3×n
  Taylor axes;    ///< AP, 3×3: from node axes to body axes
};

/// The integrals are over the mass, of r = X + Φq + ½qᵀΓq, SI units. Six-vectors are symmetric matrices: xx, yy, zz,
/// xy, then xz, yz (J) or yz, xz (Oe, which has twice the elements off the diagonal). "Column k" of Gr and Ge is the
/// k-th group of three columns.
struct Data {
  std::string title;                    ///< rest of the first line
  double mass = 0;                      ///< [kg]
  std::vector<std::string> mode_names;  ///< ielastq, one a mode
  std::vector<Node> nodes;
  Taylor mdCM;    ///< 3×1: ∫ r
  Taylor J;       ///< 6×1: ∫ (r·r 1 − r rᵀ)
  Taylor Ct;      ///< n×3: row k is ∫ (Φ_k + Γ_k q)
  Taylor Cr;      ///< n×3: row k is ∫ r × (Φ_k + Γ_k q)
  Taylor Me;      ///< n×n: ∫ Φ_k · Φ_l
  Taylor Gr;      ///< 3×3n: column k is −2 ∫ r̃ Φ̃_k; its first order has no Γ
  Taylor Ge;      ///< n×3n: row k, column l is 2 ∫ Φ_l × Φ_k
  Taylor Oe;      ///< n×6: (Φ_k + Γ_k q)·(ω × (ω × r)) = Oe_k·(ωx², ωy², ωz², ωxωy, ωyωz, ωxωz)
  Taylor ksigma;  ///< n×1: modal forces of initial stress
  Taylor Ke;      ///< n×n: stiffness
  Taylor De;      ///< n×n: damping

  [[nodiscard]] Eigen::Index modes() const { return Me.m0.rows(); }
};

/// The text is no SID file: what() says what was got and expected, and in which line.
class FormatError : public std::runtime_error {
 public:
  FormatError(int line, const std::string& message);
};

/// Reads a file's text. First-order elements m1(i, j, k) are taken as (row, mode, column), as Wallrapp has them, or
/// as (row, column, mode), as some programs write them, whichever fits every matrix of the file. Me, Ke, mdCM, J, Ct
/// and Cr must be there; other integrals may be absent, or empty. An inertia given as a 3×3 matrix becomes 6×1. \throws
/// FormatError
Data read(std::string_view text);

/// The text of a file, with 17 significant digits: reading it gives the same numbers. Absent matrices are left out.
std::string write(const Data& data);

}  // namespace withy::sid
