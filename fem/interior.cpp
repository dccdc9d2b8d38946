#include "interior.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace withy::fem {
namespace {

using Factor = Eigen::SimplicialLDLT<SparseMatrix>;

/// K⁻¹ for Spectra's iteration about the shift zero, with a factor that is there already.
class Inverse {
 public:
  using Scalar = double;
  explicit Inverse(const Factor& factor) : factor_(factor) {}
  [[nodiscard]] Eigen::Index rows() const { return factor_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return factor_.cols(); }
  void set_shift(double /*zero*/) {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) = factor_.solve(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }

 private:
  const Factor& factor_;
};

}  // namespace

Interior::Interior(const SparseMatrix& K, const SparseMatrix& M, std::vector<Eigen::Index> rows)
    : rows_(std::move(rows)), all_(K.rows()), M_(part_of(M)) {
  if (rows_.empty()) return;
  factor_.compute(part_of(K));
  if (factor_.info() != Eigen::Success || !(factor_.vectorD().minCoeff() > 0))
    throw InputError(
        "the clamped mesh is not stiff: some of it hangs on neither the root nor an interface, or its "
        "elements have motions without stiffness, as a single row of reduced ones, or its numbers have too few "
        "digits for so slender a mesh");
}

SparseMatrix Interior::part_of(const SparseMatrix& matrix) const {
  std::vector<Eigen::Index> place(static_cast<std::size_t>(all_), -1);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    place[static_cast<std::size_t>(rows_[i])] = static_cast<Eigen::Index>(i);
  std::vector<Eigen::Triplet<double>> triplets;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(matrix, column); it; ++it) {
      const Eigen::Index i = place[static_cast<std::size_t>(it.row())], j = place[static_cast<std::size_t>(column)];
      if (i >= 0 && j >= 0) triplets.emplace_back(i, j, it.value());
    }
  }
  const auto size = static_cast<Eigen::Index>(rows_.size());
  SparseMatrix part(size, size);
  part.setFromTriplets(triplets.begin(), triplets.end());
  return part;
}

Eigen::MatrixXd Interior::response(const Eigen::MatrixXd& forces) const {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(forces.rows(), forces.cols());
  if (rows_.empty()) return u;
  const Eigen::MatrixXd inside = factor_.solve(Eigen::MatrixXd(forces(rows_, Eigen::all)));
  u(rows_, Eigen::all) = inside;
  return u;
}

Interior::Modes Interior::modes(Eigen::Index count) const {
  Modes found{Eigen::MatrixXd::Zero(all_, count), {}};
  if (count == 0) return found;
  if (count >= M_.rows()) throw InputError(fmt::format("got {} modes; the interior has {} freedoms", count, M_.rows()));
  Inverse inverse(factor_);
  Spectra::SparseSymMatProd<double> mass(M_);
  const Eigen::Index krylov = std::min<Eigen::Index>(M_.rows(), std::max<Eigen::Index>(2 * count + 1, 20));
  Spectra::SymGEigsShiftSolver<Inverse, Spectra::SparseSymMatProd<double>, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, krylov, 0.0);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-11, Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful)
    throw InputError(fmt::format("the {} lowest modes were not found", count));
  for (const double lambda : solver.eigenvalues())
    found.frequencies.push_back(std::sqrt(lambda) / (2 * std::numbers::pi));
  found.shapes(rows_, Eigen::all) = solver.eigenvectors();
  return found;
}

}  // namespace withy::fem
