#include "withy/core/analysis/balanced_truncation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace withy {
namespace {

/// A root that decays by less than this share of the fastest one's modulus counts as one that does not.
constexpr double hardly_decays = 1e-7;

/// X of A X + X Aᵀ + Q = 0 by the complex Schur form of A (Bartels & Stewart 1972); A decays.
Eigen::MatrixXd gramian(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q) {
  const Eigen::Index n = A.rows();
  if (n == 0) return Q;
  const Eigen::ComplexSchur<Eigen::MatrixXd> schur(A);
  const Eigen::MatrixXcd &T = schur.matrixT(), &U = schur.matrixU();
  const Eigen::MatrixXcd F = U.adjoint() * Q * U;
  Eigen::MatrixXcd Y(n, n);
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    Eigen::VectorXcd right = -F.col(j);
    for (Eigen::Index k = j + 1; k < n; ++k) right -= std::conj(T(j, k)) * Y.col(k);
    Eigen::MatrixXcd shifted = T;
    shifted.diagonal().array() += std::conj(T(j, j));
    Y.col(j) = shifted.triangularView<Eigen::Upper>().solve(right);
  }
  const Eigen::MatrixXd X = (U * Y * U.adjoint()).real();
  return 0.5 * (X + X.transpose());
}

/// L of L Lᵀ = X, X without the negative part that rounding leaves.
Eigen::MatrixXd root(const Eigen::MatrixXd& X) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(X);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// A matrix with the eigenvectors of A and the eigenvalues ±1, the signs of the real parts, by Newton's method.
Eigen::MatrixXd sign_of(Eigen::MatrixXd S) {
  for (int k = 0; k < 100; ++k) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(S);
    const double size = lu.matrixLU().diagonal().cwiseAbs().array().log().mean();
    const double scale = std::exp(-size);
    const Eigen::MatrixXd next = 0.5 * (scale * S + lu.inverse() / scale);
    if (!next.allFinite()) break;
    const double change = (next - S).lpNorm<1>();
    S = next;
    if (change <= 1e-10 * S.lpNorm<1>()) return S;
  }
  throw std::domain_error("motions that decay and those that do not cannot be told apart");
}

/// Brings A to a block diagonal: what decays first. \returns the size of that block
Eigen::Index split(LinearSystem& s) {
  const Eigen::VectorXcd roots = poles(s);
  const double least = hardly_decays * roots.cwiseAbs().maxCoeff();
  double slowest = std::numeric_limits<double>::infinity();
  Eigen::Index decaying = 0;
  for (const std::complex<double> root : roots) {
    if (!(root.real() < -least)) continue;
    ++decaying;
    slowest = std::min(slowest, -root.real());
  }
  if (decaying == 0 || decaying == s.A.rows()) return decaying;
  const Eigen::Index n = s.A.rows();
  const double shift = std::sqrt(slowest * std::max(least, 1e-3 * slowest));
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n), S = sign_of(s.A + shift * one);
  Eigen::MatrixXd basis(n, n);
  const auto range = [](const Eigen::MatrixXd& P) -> Eigen::MatrixXd {
    return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(P).householderQ();
  };
  basis << range(0.5 * (one - S)).leftCols(decaying), range(0.5 * (one + S)).leftCols(n - decaying);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(basis);
  s.A = lu.solve(s.A * basis);
  s.B = lu.solve(s.B);
  s.C = s.C * basis;
  if (!s.A.allFinite()) throw std::domain_error("motions that decay and those that do not cannot be told apart");
  return decaying;
}

/// s = (z − 1)/(z + 1), or back where `forth` is false.
LinearSystem bilinear(const LinearSystem& from, bool forth, double period) {
  const Eigen::Index n = from.A.rows();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  const double sign = forth ? 1 : -1;
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(one + sign * from.A);
  const Eigen::MatrixXd inverse = lu.inverse();
  if (!inverse.allFinite()) throw std::domain_error("a multiplier of the sampled system is -1");
  LinearSystem to{inverse * (from.A - sign * one), std::sqrt(2) * inverse * from.B, std::sqrt(2) * from.C * inverse,
                  from.D, period};
  to.D -= sign * from.C * inverse * from.B;
  return to;
}

}  // namespace

Reduction balanced_truncation(const LinearSystem& given, Eigen::Index order) {
  LinearSystem s = given;
  balance(s);
  if (given.sampled()) s = bilinear(s, true, 0);
  Reduction result;
  const Eigen::Index n = s.A.rows(), decaying = n > 0 ? split(s) : 0;
  result.kept = n - decaying;
  const Eigen::MatrixXd A = s.A.topLeftCorner(decaying, decaying), B = s.B.topRows(decaying),
                        C = s.C.leftCols(decaying);
  const Eigen::MatrixXd reached = root(gramian(A, B * B.transpose()));
  const Eigen::MatrixXd seen = root(gramian(A.transpose(), C.transpose() * C));
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(seen.transpose() * reached, Eigen::ComputeThinU | Eigen::ComputeThinV);
  result.hankel = svd.singularValues();
  Eigen::Index taken = std::clamp<Eigen::Index>(order - result.kept, 0, decaying);
  // What is neither reached nor seen has no balanced state.
  while (taken > 0 && !(result.hankel[taken - 1] > 1e-14 * result.hankel[0])) --taken;
  result.bound = 2 * result.hankel.tail(decaying - taken).sum();
  const Eigen::VectorXd scale = result.hankel.head(taken).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd right = reached * svd.matrixV().leftCols(taken) * scale.asDiagonal();
  const Eigen::MatrixXd left = seen * svd.matrixU().leftCols(taken) * scale.asDiagonal();
  LinearSystem& r = result.system;
  const Eigen::Index size = taken + result.kept;
  r.A.setZero(size, size);
  r.A.topLeftCorner(taken, taken) = left.transpose() * A * right;
  r.A.bottomRightCorner(result.kept, result.kept) = s.A.bottomRightCorner(result.kept, result.kept);
  r.B.resize(size, s.B.cols());
  r.B << left.transpose() * B, s.B.bottomRows(result.kept);
  r.C.resize(s.C.rows(), size);
  r.C << C * right, s.C.rightCols(result.kept);
  r.D = s.D;
  if (given.sampled()) r = bilinear(r, false, given.period);
  return result;
}

}  // namespace withy
