/// \file
/// What of Eigen is slow to instantiate and used in many sources: compiled once, in eigen_instances.cpp. See
/// cmake/WithyBuildTime.cmake. Functions that Eigen means to be inlined are not among them.
#pragma once

#include <Eigen/Dense>

// WITHY_INSTANCE is `extern template` where they are used and `template` where they are compiled.
#ifndef WITHY_INSTANCE
#define WITHY_INSTANCE extern template
#endif

namespace Eigen {
namespace internal {

using Pack = gebp_traits<double, double>;
using ConstColumns = const_blas_data_mapper<double, Index, ColMajor>;
using ConstRows = const_blas_data_mapper<double, Index, RowMajor>;
using Columns = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;

// Matrix times matrix.
WITHY_INSTANCE struct gebp_kernel<double, double, Index, Columns, Pack::mr, Pack::nr, false, false>;
WITHY_INSTANCE struct gemm_pack_lhs<double, Index, ConstColumns, Pack::mr, Pack::LhsProgress, Pack::LhsPacket4Packing,
                                    ColMajor>;
WITHY_INSTANCE struct gemm_pack_lhs<double, Index, ConstRows, Pack::mr, Pack::LhsProgress, Pack::LhsPacket4Packing,
                                    RowMajor>;
WITHY_INSTANCE struct gemm_pack_rhs<double, Index, ConstColumns, Pack::nr, ColMajor>;
WITHY_INSTANCE struct gemm_pack_rhs<double, Index, ConstRows, Pack::nr, RowMajor>;

// Matrix times vector.
WITHY_INSTANCE struct general_matrix_vector_product<Index, double, ConstColumns, ColMajor, false, double, ConstRows,
                                                    false>;
WITHY_INSTANCE struct general_matrix_vector_product<Index, double, ConstColumns, ColMajor, false, double, ConstColumns,
                                                    false>;
WITHY_INSTANCE struct general_matrix_vector_product<Index, double, ConstRows, RowMajor, false, double, ConstColumns,
                                                    false>;

// Triangular systems with many right-hand sides.
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor, ColMajor, 1>;
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor, 1>;
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false, ColMajor, ColMajor, 1>;
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor, ColMajor, 1>;
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false, ColMajor, ColMajor, 1>;
WITHY_INSTANCE struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false, RowMajor, ColMajor, 1>;

// Complex matrices and vectors.
using ComplexPack = gebp_traits<std::complex<double>, std::complex<double>>;
using ConstComplexColumns = const_blas_data_mapper<std::complex<double>, Index, ColMajor>;
using ConstComplexRows = const_blas_data_mapper<std::complex<double>, Index, RowMajor>;
using ComplexColumns = blas_data_mapper<std::complex<double>, Index, ColMajor, Unaligned, 1>;
WITHY_INSTANCE struct gebp_kernel<std::complex<double>, std::complex<double>, Index, ComplexColumns, ComplexPack::mr,
                                  ComplexPack::nr, false, false>;
WITHY_INSTANCE struct general_matrix_vector_product<Index, std::complex<double>, ConstComplexColumns, ColMajor, false,
                                                    std::complex<double>, ConstComplexRows, false>;
WITHY_INSTANCE struct general_matrix_vector_product<Index, std::complex<double>, ConstComplexColumns, ColMajor, false,
                                                    std::complex<double>, ConstComplexColumns, false>;
WITHY_INSTANCE struct general_matrix_vector_product<Index, std::complex<double>, ConstComplexRows, RowMajor, false,
                                                    std::complex<double>, ConstComplexColumns, false>;

// Orthogonal matrices as products of reflections.
using Part = Block<MatrixXd, Dynamic, Dynamic, false>;
using Triangle = Matrix<double, Dynamic, Dynamic, RowMajor>;
WITHY_INSTANCE void make_block_householder_triangular_factor(Triangle&, const Part&,
                                                             const Block<const VectorXd, Dynamic, 1, false>&);
WITHY_INSTANCE void make_block_householder_triangular_factor(Triangle&, const Part&,
                                                             const VectorBlock<const VectorXd>&);
WITHY_INSTANCE void apply_block_householder_on_the_left(Part&, const Part&, const VectorBlock<const VectorXd>&, bool);

}  // namespace internal

WITHY_INSTANCE void MatrixBase<internal::Part>::applyHouseholderOnTheLeft(
    const Block<const MatrixXd, Dynamic, 1, false>&, const double&, double*);
WITHY_INSTANCE void MatrixBase<internal::Part>::applyHouseholderOnTheLeft(
    const VectorBlock<Block<MatrixXd, Dynamic, 1, true>>&, const double&, double*);
WITHY_INSTANCE void MatrixBase<internal::Part>::applyHouseholderOnTheRight(
    const Block<const MatrixXd, Dynamic, 1, false>&, const double&, double*);
WITHY_INSTANCE void ComplexSchur<MatrixXd>::reduceToTriangularForm(bool);

WITHY_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                                           int);
WITHY_INSTANCE GeneralizedSelfAdjointEigenSolver<MatrixXd>& GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(
    const MatrixXd&, const MatrixXd&, int);
WITHY_INSTANCE LLT<MatrixXd, Lower>& LLT<MatrixXd, Lower>::compute(const EigenBase<MatrixXd>&);
WITHY_INSTANCE void PartialPivLU<MatrixXd>::compute();
WITHY_INSTANCE void PartialPivLU<MatrixXcd>::compute();
WITHY_INSTANCE void FullPivLU<MatrixXd>::computeInPlace();
WITHY_INSTANCE void HouseholderQR<MatrixXd>::computeInPlace();
WITHY_INSTANCE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
WITHY_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
WITHY_INSTANCE LDLT<MatrixXd, Lower>& LDLT<MatrixXd, Lower>::compute(const EigenBase<MatrixXd>&);
WITHY_INSTANCE EigenSolver<Matrix3d>& EigenSolver<Matrix3d>::compute(const EigenBase<Matrix3d>&, bool);
WITHY_INSTANCE SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(const EigenBase<Matrix3d>&,
                                                                                           int);
WITHY_INSTANCE JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd&, unsigned int);
WITHY_INSTANCE EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

// Solutions; arguments that are no matrices or vectors are instantiated anew here too.
WITHY_INSTANCE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
WITHY_INSTANCE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
WITHY_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
WITHY_INSTANCE void FullPivLU<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;

}  // namespace Eigen
