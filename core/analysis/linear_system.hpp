/// \file
/// Linear systems with inputs and outputs, in continuous time or sampled: poles, zeros, values of transfer functions.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <utility>

namespace withy {

/// ż = A z + B v, y = C z + D v. Where `period` is above 0, z and y are those at the samples k · period, between which
/// v is held: z_{k+1} = A z_k + B v_k, y_k = C z_k + D v_k.
struct LinearSystem {
  Eigen::MatrixXd A, B, C, D;
  double period = 0;  ///< [s]

  [[nodiscard]] bool sampled() const { return period > 0; }
  /// s = iω, or z = e^{iωT} of a sampled system.
  [[nodiscard]] std::complex<double> at_frequency(double omega) const;
  /// The system of one input and one output.
  [[nodiscard]] LinearSystem between(Eigen::Index input, Eigen::Index output) const;
};

/// Φ and Γ of z(T) = Φ z(0) + Γ v with v held over T, by the matrix exponential.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> hold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double T);

/// A with its states in other units, so that rows and columns are alike (Parlett & Reinsch 1969): powers of two, so
/// that nothing is rounded. \returns the units: z = units · balanced z
Eigen::VectorXd balance(LinearSystem& system);

/// The units that it finds for a matrix by itself, of states from `first` on: units⁻¹ A units is balanced in these.
Eigen::VectorXd balance_of_states(Eigen::MatrixXd A, Eigen::Index first = 0);

/// Eigenvalues of A, complex pairs side by side. Those at zero, of a sampled system those at one, are found by rank,
/// not as numbers near by: rigid motions and integrators are chains of them. \throws std::domain_error where A is not
/// finite
Eigen::VectorXcd poles(const LinearSystem& system);

/// Eigenvalues, and what rounding may have moved them by; zero of those found by rank.
struct KnownRoots {
  Eigen::VectorXcd values;
  Eigen::VectorXd errors;
};
/// The same as `poles`.
KnownRoots known_poles(const LinearSystem& system);

/// How many eigenvalues of A are zero, by rank as in `poles`.
std::size_t zeros_of(const Eigen::MatrixXd& A);

/// What rates are to be divided by in a first-order form (δ̇ = u, u̇ = −K δ − G u) for both halves to be of one size.
double unit_of_rates(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G);

/// What G(s) = C (s − A)⁻¹ B + D is: gain · ∏ (s − zero) / ∏ (s − pole) of one input and one output.
struct ZerosAndGain {
  KnownRoots zeros;  ///< finite ones
  double gain = 0;   ///< 0: the output does not feel the input
};
/// The finite generalized eigenvalues of the Rosenbrock pencil [A − s, B; C, D]. Each infinite one is taken off by an
/// orthogonal transformation that leaves a smaller pencil (Emami-Naeini & Van Dooren 1982): where D is zero, that is
/// less than some 1e-11 of ‖B‖ ‖C‖ as they stand at that stage, the state seen in y must stay at zero.
ZerosAndGain zeros(LinearSystem system);

/// Values of a transfer function at many places: a reduction to Hessenberg form once, then O(n²) each.
class TransferFunction {
 public:
  explicit TransferFunction(LinearSystem system);
  /// Outputs × inputs; not finite at a pole.
  [[nodiscard]] Eigen::MatrixXcd operator()(std::complex<double> s) const;
  /// Of the first input and output at a frequency [rad/s].
  [[nodiscard]] std::complex<double> at_frequency(double omega) const { return (*this)(of_.at_frequency(omega))(0, 0); }
  /// Balanced and in Hessenberg form.
  [[nodiscard]] const LinearSystem& system() const { return of_; }
  /// As it was given. In Hessenberg form states are mixed, and what feedback adds to A cannot be balanced any more.
  [[nodiscard]] const LinearSystem& given() const { return given_; }

 private:
  LinearSystem given_, of_;
};

}  // namespace withy
