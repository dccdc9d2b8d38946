/// \file
/// Stresses of solid elements and the geometric stiffness that they give.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "matrices.hpp"

namespace withy::fem {

/// The elements of a deck, linear and isotropic, integrated as CalculiX does.
class SolidElements {
 public:
  /// \throws InputError where the deck does not describe all of them: what() says what is missing.
  SolidElements(const Mesh& mesh, const Matrices& matrices);

  /// Forces on the nodes that the stresses balance, ∫ Bᵀ σ(u) = K u; 3N×m of displacements 3N×m.
  [[nodiscard]] Eigen::MatrixXd forces(const Eigen::MatrixXd& displacements) const;

  /// G(u; φ_k, φ_l) = ∫ σ(u) : ∇φ_kᵀ ∇φ_l dV for every column u of `displacements` and all pairs of `fields`, each with
  /// 3N rows: what the stress σ(u) adds to the stiffness. One n×n matrix a displacement.
  [[nodiscard]] std::vector<Eigen::MatrixXd> geometric_stiffness(const Eigen::MatrixXd& displacements,
                                                                 const Eigen::MatrixXd& fields) const;

  /// Forces on the nodes that do −∫ σ(δ) : ∇φ_kᵀ ∇φ_l dV of work on every displacement δ, of all pairs k ≤ l of
  /// `fields`, k outermost: 3N×n(n+1)/2.
  [[nodiscard]] Eigen::MatrixXd second_order_forces(const Eigen::MatrixXd& fields) const;

 private:
  struct Point {
    double volume;
    Matrix3X gradient;  ///< of the shape functions, 3×nodes [1/m]
  };
  struct Solid {
    std::vector<Eigen::Index> rows;  ///< nodes, as in Matrices
    double shear, lame;              ///< σ = 2 shear ε + lame tr(ε) 1 [N/m²]
    std::vector<Point> points;
  };
  [[nodiscard]] static Matrix3X at_nodes(const Solid& solid, const Eigen::MatrixXd& fields, Eigen::Index column);
  [[nodiscard]] static Matrix3 stress(const Solid& solid, const Point& point, const Matrix3X& u);
  [[nodiscard]] static Matrix3 stress_of(const Solid& solid, const Matrix3& strain);

  Eigen::Index nodes_;
  std::vector<Solid> solids_;
};

}  // namespace withy::fem
