#include "withy/core/analysis/linear_system.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "withy/core/analysis/balance_with_ends.hpp"
#include "withy/core/analysis/beside_one.hpp"
#include "withy/core/analysis/unheld.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

/// What rounding of a matrix moves its eigenvalues by: its size times what the vectors of each make of it, and of
/// double ones without two vectors, of which the vectors tell nothing, its root.
Eigen::VectorXd moved_by_rounding(const Eigen::MatrixXcd& vectors, double of_matrix, double size) {
  const Eigen::MatrixXcd left = Eigen::PartialPivLU<Eigen::MatrixXcd>(vectors).inverse();
  Eigen::VectorXd moved(vectors.cols());
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    const double at_most = std::sqrt(of_matrix * size), here = of_matrix * left.row(i).norm() * vectors.col(i).norm();
    moved[i] = here < at_most ? here : at_most;
  }
  return moved;
}

/// Eigenvalues with zero for each direction that A takes to nothing, and again for what is left without it: a chain of
/// integrators, whose eigenvalues rounding would spread by its root, is taken apart link by link. Those are exact.
/// \param rounding of elements, beside that of A itself
KnownRoots eigenvalues_with_zeros(const Eigen::MatrixXd& A, double rounding) {
  constexpr double share = 1e-13;
  if (!A.allFinite()) throw std::domain_error("the linear system is not finite");
  KnownRoots roots{Eigen::VectorXcd::Zero(A.rows()), Eigen::VectorXd::Zero(A.rows())};
  Eigen::MatrixXd left = A, of_elements = rounding_of(A).array() + rounding;
  for (Eigen::MatrixXd gone = unheld_but_for(left, of_elements); gone.cols() > 0;
       gone = unheld_but_for(left, of_elements)) {
    const Quotient link(left, gone);
    of_elements = link.rounding(of_elements);
    left = link.matrix();
  }
  if (left.rows() == 0) return roots;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(left);
  if (solver.info() != Eigen::Success) throw std::domain_error("the eigenvalues were not found");
  roots.values.head(left.rows()) = solver.eigenvalues();
  const double size = left.norm();
  roots.errors.head(left.rows()) = moved_by_rounding(solver.eigenvectors(), share * size, size);
  return roots;
}

}  // namespace

Complex LinearSystem::at_frequency(double omega) const {
  return sampled() ? std::polar(1.0, omega * period) : Complex(0, omega);
}

LinearSystem LinearSystem::between(Eigen::Index input, Eigen::Index output) const {
  return {A, B.col(input), C.row(output), D.block(output, input, 1, 1), period};
}

Eigen::VectorXd balance_of_states(Eigen::MatrixXd A, Eigen::Index first) {
  const Eigen::Index n = A.rows();
  Eigen::VectorXd units = Eigen::VectorXd::Ones(n);
  bool better = true;
  for (int round = 0; better && round < 100; ++round) {
    better = false;
    for (Eigen::Index i = first; i < n; ++i) {
      const double own = std::abs(A(i, i));
      const double column = A.col(i).lpNorm<1>() - own, row = A.row(i).lpNorm<1>() - own;
      if (!(column > 0) || !(row > 0)) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (column * f + row / f > 0.95 * (column + row)) continue;
      A.col(i) *= f;
      A.row(i) /= f;
      units[i] *= f;
      better = true;
    }
  }
  return units;
}

Eigen::VectorXd balance(LinearSystem& s) {
  const Eigen::VectorXd units = balance_of_states(s.A);
  // Powers of two: nothing is rounded.
  s.A = (units.cwiseInverse().asDiagonal() * s.A * units.asDiagonal()).eval();
  s.B = units.cwiseInverse().asDiagonal() * s.B;
  s.C = s.C * units.asDiagonal();
  return units;
}

void balance_with_ends(LinearSystem& s) {
  const Eigen::Index n = s.A.rows();
  Eigen::MatrixXd closed = Eigen::MatrixXd::Zero(n + 1, n + 1);
  closed << s.A, s.B, s.C, 0;
  LinearSystem all{closed, Eigen::MatrixXd::Zero(n + 1, 0), Eigen::MatrixXd::Zero(0, n + 1), {}};
  balance(all);
  s.A = all.A.topLeftCorner(n, n);
  s.B = all.A.topRightCorner(n, 1);
  s.C = all.A.bottomLeftCorner(1, n);
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> hold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double T) {
  const Eigen::Index n = A.rows(), m = B.cols();
  // The exponential is exact for the norm of all of it: in units in which states, and inputs beside them, are of one
  // size. What a newton does to a gram is a large number, and what matters to it would be lost beside it.
  LinearSystem s{A, B, Eigen::MatrixXd::Zero(0, n), Eigen::MatrixXd::Zero(0, m)};
  const Eigen::VectorXd of_states = balance(s);
  Eigen::VectorXd of_inputs = Eigen::VectorXd::Ones(m);
  const double size = s.A.norm();
  for (Eigen::Index k = 0; k < m; ++k)
    if (const double felt = s.B.col(k).norm(); felt > 0)
      of_inputs[k] = std::exp2(std::round(std::log2((size > 0 ? size : 1) / felt)));
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = s.A * T;
  both.topRightCorner(n, m) = s.B * of_inputs.asDiagonal() * T;
  if (!both.allFinite()) throw std::domain_error("the linear system is not finite");
  const Eigen::MatrixXd e = both.exp();
  return {of_states.asDiagonal() * e.topLeftCorner(n, n) * of_states.cwiseInverse().asDiagonal(),
          of_states.asDiagonal() * e.topRightCorner(n, m) * of_inputs.cwiseInverse().asDiagonal()};
}

KnownRoots known_poles(const LinearSystem& system) {
  LinearSystem s = system;
  balance(s);
  if (!s.sampled()) return eigenvalues_with_zeros(s.A, 0);
  // What rests between samples stands at 1.
  const double size = std::max(1.0, s.A.size() > 0 ? s.A.cwiseAbs().maxCoeff() : 0.0);
  s.A.diagonal().array() -= 1;
  KnownRoots roots = eigenvalues_with_zeros(s.A, beside_one(s.A.rows()) * size);
  roots.values.array() += 1;
  return roots;
}

Eigen::VectorXcd poles(const LinearSystem& system) { return known_poles(system).values; }

std::size_t zeros_of(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd exact =
      poles({A, Eigen::MatrixXd::Zero(A.rows(), 0), Eigen::MatrixXd::Zero(0, A.rows()), Eigen::MatrixXd()});
  return static_cast<std::size_t>((exact.array() == Complex(0)).count());
}

double unit_of_rates(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) {
  const double stiffest = K.size() > 0 ? K.cwiseAbs().maxCoeff() : 0.0;
  if (stiffest > 0) return std::sqrt(stiffest);
  const double fastest = G.size() > 0 ? G.cwiseAbs().maxCoeff() : 0.0;
  return fastest > 0 ? fastest : 1.0;
}

TransferFunction::TransferFunction(LinearSystem system) : given_(std::move(system)), of_(given_) {
  if (of_.B.cols() == 1 && of_.C.rows() == 1)
    balance_with_ends(of_);
  else
    balance(of_);
  if (of_.A.rows() < 2) return;
  const Eigen::HessenbergDecomposition<Eigen::MatrixXd> form(of_.A);
  const Eigen::MatrixXd Q = form.matrixQ();
  of_.A = form.matrixH();
  of_.B = Q.transpose() * of_.B;
  of_.C = of_.C * Q;
}

Eigen::MatrixXcd TransferFunction::operator()(Complex s) const {
  const Eigen::Index n = of_.A.rows();
  // Gaussian elimination below the diagonal of a Hessenberg matrix: one row a column, neighbours exchanged.
  Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> H = -of_.A.cast<Complex>(),
                                                                          x = of_.B.cast<Complex>();
  H.diagonal().array() += s;
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    if (std::abs(H(k + 1, k)) > std::abs(H(k, k))) {
      H.row(k).tail(n - k).swap(H.row(k + 1).tail(n - k));
      x.row(k).swap(x.row(k + 1));
    }
    if (H(k + 1, k) == 0.0) continue;
    const Complex factor = H(k + 1, k) / H(k, k);
    H.row(k + 1).tail(n - k) -= factor * H.row(k).tail(n - k);
    x.row(k + 1) -= factor * x.row(k);
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    for (Eigen::Index j = k + 1; j < n; ++j) x.row(k) -= H(k, j) * x.row(j);
    x.row(k) /= H(k, k);
  }
  return of_.C.cast<Complex>() * x + of_.D.cast<Complex>();
}

}  // namespace withy
