/// \file
/// How well zeros of a transfer function are known, told by the system that they are zeros of.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <optional>

#include "withy/core/analysis/linear_system.hpp"

namespace withy {

/// The pencil P(s) = [D, C; B, A − s] of one input and one output, which is singular at zeros, in Hessenberg form: the
/// reflections leave the end as it is, and with it where s stands. Each place then costs O(n²).
class ZeroErrors {
 public:
  /// \param s balanced, with states; neither B nor C is zero
  /// \param known what elements of A may be off by beside rounding of themselves
  ZeroErrors(const LinearSystem& s, double known);

  /// What a zero may be off by: its distance from that of P as given, which its left and right vectors tell, and
  /// rounding of the elements of P. Of zeros nearer to each other than that, which have no vectors of their own: twice
  /// the radius about it within which as many zeros of P are, and stay whatever rounding does to P;
  /// infinite where that is no small part of P and the zero, as of many in one place.
  [[nodiscard]] double of(const Eigen::VectorXcd& zeros, Eigen::Index i) const;

 private:
  struct Known {
    double error = 0;    ///< of a zero that its vectors are of alone
    double vectors = 0;  ///< how far other zeros are at least if they are
  };
  [[nodiscard]] Known of_one(std::complex<double> zero) const;
  [[nodiscard]] double of_many(const Eigen::VectorXcd& zeros, Eigen::Index i) const;
  /// Whether a circle has that many zeros of P within, and rounding of P takes none across.
  [[nodiscard]] bool encloses(std::complex<double> center, double radius, std::ptrdiff_t count) const;
  /// Direction of the determinant of P; nothing where P is singular but for rounding.
  [[nodiscard]] std::optional<std::complex<double>> direction_if_regular(std::complex<double> s) const;

  Eigen::MatrixXd P_, sizes_;  ///< P(0); what its elements are known against
  Eigen::MatrixXd H_, Q_;      ///< Q H Qᵀ = P(0)
  double norm_;
};

}  // namespace withy
