/// \file
/// What is inside a mesh whose other rows are held.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "matrices.hpp"

namespace withy::fem {

/// Statics and normal modes of some rows of K and M, all others held.
class Interior {
 public:
  /// `rows` of K, ascending; there may be none. \throws InputError where they are not stiff.
  Interior(const SparseMatrix& K, const SparseMatrix& M, std::vector<Eigen::Index> rows);

  /// Displacements under forces on the rows of K, both as many rows as K has.
  [[nodiscard]] Eigen::MatrixXd response(const Eigen::MatrixXd& forces) const;
  struct Modes {
    Eigen::MatrixXd shapes;           ///< as many rows as K has, zero where held
    std::vector<double> frequencies;  ///< [Hz]
  };
  /// The lowest. \throws InputError where there are not so many, or they are not found.
  [[nodiscard]] Modes modes(Eigen::Index count) const;

 private:
  [[nodiscard]] SparseMatrix part_of(const SparseMatrix& matrix) const;

  std::vector<Eigen::Index> rows_;
  Eigen::Index all_;
  SparseMatrix M_;
  Eigen::SimplicialLDLT<SparseMatrix> factor_;
};

}  // namespace withy::fem
