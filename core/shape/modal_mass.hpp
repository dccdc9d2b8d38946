/// \file
/// The mass matrix of a body's modes, and the products of fields it is the sum of.
#pragma once

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// G += w ΦᵀΦ of fields Φ, one a column. (Compiled once, and without the blocks that Eigen cuts great products into,
/// which a source takes seconds to compile: three rows need none.)
void add_products(double w, const Matrix3X& fields, Eigen::MatrixXd& G);
/// G += Φᵀ S Φ.
void add_products(const Matrix3& S, const Matrix3X& fields, Eigen::MatrixXd& G);
/// G = Σ m ΦᵀΦ + Σ ΨᵀIΨ [kg]: the mass matrix of the modes of the undeformed body, its root
/// held.
Eigen::MatrixXd modal_mass(const ModalShape& shape);

}  // namespace withy
