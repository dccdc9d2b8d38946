#include "withy/core/analysis/zero_errors.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace withy {
namespace {

using Complex = std::complex<double>;

constexpr double rounding_of_one = std::numeric_limits<double>::epsilon();

/// H − s N, N one but for its first element, by Gaussian elimination below the diagonal with neighbours exchanged.
class Factors {
 public:
  Factors(const Eigen::MatrixXd& H, Complex s, double norm)
      : upper_(H.cast<Complex>()), factors_(H.rows()), swapped_(static_cast<std::size_t>(H.rows()), false) {
    const Eigen::Index n = H.rows();
    upper_.diagonal().tail(n - 1).array() -= s;
    // A pivot of nothing stands for rounding: vectors are sought where the matrix is singular.
    const double least = rounding_of_one * norm;
    const auto hold = [least](Complex& pivot) {
      if (!(std::abs(pivot) > least)) pivot = least;
    };
    for (Eigen::Index k = 0; k + 1 < n; ++k) {
      if (std::abs(upper_(k + 1, k)) > std::abs(upper_(k, k))) {
        upper_.row(k).tail(n - k).swap(upper_.row(k + 1).tail(n - k));
        swapped_[static_cast<std::size_t>(k)] = true;
      }
      hold(upper_(k, k));
      factors_[k] = upper_(k + 1, k) / upper_(k, k);
      upper_.row(k + 1).tail(n - k) -= factors_[k] * upper_.row(k).tail(n - k);
    }
    hold(upper_(n - 1, n - 1));
  }
  /// Direction of the determinant.
  [[nodiscard]] Complex direction() const {
    Complex product = std::count(swapped_.begin(), swapped_.end(), true) % 2 == 0 ? 1 : -1;
    for (Eigen::Index k = 0; k < upper_.rows(); ++k) product *= upper_(k, k) / std::abs(upper_(k, k));
    return product;
  }
  [[nodiscard]] Eigen::VectorXcd solve(Eigen::VectorXcd x) const {
    for (Eigen::Index k = 0; k + 1 < x.size(); ++k) {
      if (swapped_[static_cast<std::size_t>(k)]) std::swap(x[k], x[k + 1]);
      x[k + 1] -= factors_[k] * x[k];
    }
    upper_.triangularView<Eigen::Upper>().solveInPlace(x);
    return x;
  }
  [[nodiscard]] Eigen::VectorXcd solve_adjoint(Eigen::VectorXcd y) const {
    upper_.adjoint().triangularView<Eigen::Lower>().solveInPlace(y);
    for (Eigen::Index k = y.size() - 2; k >= 0; --k) {
      y[k] -= std::conj(factors_[k]) * y[k + 1];
      if (swapped_[static_cast<std::size_t>(k)]) std::swap(y[k], y[k + 1]);
    }
    return y;
  }

 private:
  Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> upper_;
  Eigen::VectorXcd factors_;
  std::vector<bool> swapped_;
};

/// What input and output are multiplied by, powers of two, for no row and no column at the end to outgrow A.
void unite(Eigen::MatrixXd& P) {
  const Eigen::Index n = P.rows() - 1;
  const double of_A = P.bottomRightCorner(n, n).norm();
  const auto power = [of_A](double size) {
    return of_A > 0 && size > 0 ? std::exp2(std::round(std::log2(of_A / size))) : 1.0;
  };
  P.col(0) *= power(P.col(0).tail(n).norm());
  P.row(0) *= power(P.row(0).norm());
}

}  // namespace

ZeroErrors::ZeroErrors(const LinearSystem& s, double known) {
  const Eigen::Index n = s.A.rows();
  P_.resize(n + 1, n + 1);
  P_ << s.D, s.C, s.B, s.A;
  unite(P_);
  sizes_ = P_.cwiseAbs();
  sizes_.bottomRightCorner(n, n).diagonal().array() += known / rounding_of_one;
  const Eigen::HessenbergDecomposition<Eigen::MatrixXd> form(P_);
  H_ = form.matrixH();
  Q_ = form.matrixQ();
  norm_ = P_.norm();
}

ZeroErrors::Known ZeroErrors::of_one(Complex zero) const {
  const Eigen::Index n = P_.rows() - 1;
  const Factors factors(H_, zero, norm_);
  Eigen::VectorXcd right = Eigen::VectorXcd::Ones(n + 1), left = right;
  constexpr int rounds = 3;  // one is enough where no other zero is near
  for (int round = 0; round < rounds; ++round) {
    right[0] = left[0] = 0;
    right = factors.solve(right).normalized();
    left = factors.solve_adjoint(left).normalized();
  }
  right = Q_ * right;
  left = Q_ * left;
  Eigen::VectorXcd remains = P_ * right;
  remains.tail(n) -= zero * right.tail(n);
  const Complex slope = left.tail(n).dot(right.tail(n)), away = left.dot(remains) / slope;
  const Eigen::VectorXd a = left.cwiseAbs(), b = right.cwiseAbs();
  const double terms = a.dot(sizes_ * b) + std::abs(zero) * a.tail(n).dot(b.tail(n));
  remains.tail(n) -= away * right.tail(n);
  // Each sum of P times a vector rounds as many times as it has terms.
  const double rounding = static_cast<double>(n + 3) * rounding_of_one * terms / std::abs(slope);
  const double error = 2 * std::abs(away) + rounding;
  return {error, std::max(error, remains.norm() / std::abs(slope))};
}

std::optional<Complex> ZeroErrors::direction_if_regular(Complex s) const {
  const Factors factors(H_, s, norm_);
  Eigen::VectorXcd right = Eigen::VectorXcd::Ones(H_.rows());
  double grown = 0;
  for (int round = 0; round < 2; ++round) {
    const Eigen::VectorXcd left = factors.solve_adjoint(right).normalized();
    right = factors.solve(left);
    grown = right.norm();
    right /= grown;
  }
  const double rounding = static_cast<double>(H_.rows()) * rounding_of_one * (norm_ + std::abs(s));
  if (!(grown * rounding < 1)) return {};
  return factors.direction();
}

bool ZeroErrors::encloses(Complex zero, double radius, std::ptrdiff_t count) const {
  constexpr int directions = 16;
  using std::numbers::pi;
  double turned = 0;
  Complex first = 0, before = 0;
  for (int k = 0; k <= directions; ++k) {
    const auto now = k == directions ? std::optional<Complex>(first)
                                     : direction_if_regular(zero + std::polar(radius, 2 * pi * (k + 0.5) / directions));
    if (!now) return false;
    if (k == 0) first = *now;
    if (k > 0) turned += std::arg(*now / before);
    before = *now;
  }
  return std::lround(std::abs(turned) / (2 * pi)) == count;
}

double ZeroErrors::of_many(const Eigen::VectorXcd& zeros, Eigen::Index i) const {
  const Eigen::ArrayXd apart = (zeros.array() - zeros[i]).abs();
  const double size = norm_ + std::abs(zeros[i]);
  constexpr double hardly = 1e-3;
  for (double radius = rounding_of_one * size; radius < hardly * size; radius *= 2)
    // They are within, wherever: one may be across from where it was found.
    if (encloses(zeros[i], radius, (apart < radius).count())) return 2 * radius;
  return std::numeric_limits<double>::infinity();
}

double ZeroErrors::of(const Eigen::VectorXcd& zeros, Eigen::Index i) const {
  constexpr double apart = 4;
  const Known one = of_one(zeros[i]);
  const auto near = ((zeros.array() - zeros[i]).abs() <= apart * one.vectors).count();
  return near == 1 && std::isfinite(one.vectors) ? one.error : of_many(zeros, i);
}

}  // namespace withy
