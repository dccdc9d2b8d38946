/// \file
/// Linear systems with periodic coefficients, ż = A(t) z: their multipliers and characteristic exponents (Floquet
/// 1883).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <utility>
#include <vector>

namespace withy {

/// A matrix of period T as the trigonometric polynomial through an odd number of samples at equal intervals.
class PeriodicMatrix {
 public:
  PeriodicMatrix(const std::vector<Eigen::MatrixXd>& samples, double period);
  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] Eigen::Index rows() const { return mean_.rows(); }
  [[nodiscard]] const Eigen::MatrixXd& mean() const { return mean_; }
  [[nodiscard]] Eigen::MatrixXd at(double t) const;
  /// The same with z in other units: u A u⁻¹, u one a row.
  [[nodiscard]] PeriodicMatrix in_units(const Eigen::VectorXd& units) const;
  [[nodiscard]] int samples() const { return samples_; }
  /// By how much A was seen to be another between the samples [1/s], in units that make each coordinate's frequency the
  /// size of its elements: exponents are not known better.
  [[nodiscard]] double unseen() const { return unseen_; }
  void set_unseen(double rate) { unseen_ = rate; }
  /// Greatest element of all harmonics but the mean, of the greatest of all.
  [[nodiscard]] double change() const { return change_; }

 private:
  double period_;
  int samples_;
  Eigen::MatrixXd mean_;
  std::vector<std::pair<int, Eigen::MatrixXcd>> harmonics_;  ///< those that are not rounding
  double change_ = 0, unseen_ = 0;
};

/// A motion e^{λt} p(t), p of the period of A.
struct CharacteristicMode {
  std::complex<double> multiplier;  ///< e^{λT}
  /// λ [1/s]. Its imaginary part, of which the multiplier tells the remainder by 2π/T alone, is that of the strongest
  /// harmonic of the displacements: the frequency that is seen. Imaginary part ≥ 0: of a conjugate pair only one.
  std::complex<double> exponent;
  double share = 1;                              ///< of the strongest harmonic in p, of Σ |p_n|² weighted by inertia
  std::vector<std::pair<double, double>> lines;  ///< frequency [rad/s] and share, strongest first, of shares from 1 %
  Eigen::VectorXcd shape;     ///< displacements of that harmonic, one a row of the upper half; the dominating one is 1
  Eigen::Index dominant = 0;  ///< row with the greatest |p_i|² m_i
  bool resolved = true;       ///< false: the motion decays in a turn to what rounding leaves of others
};

struct FloquetAnalysis {
  double period = 0;                      ///< [s]
  std::vector<CharacteristicMode> modes;  ///< most unstable first
  double resolution = 0;                  ///< [1/s]: real parts below this are zero as far as can be told
  int steps = 0;                          ///< of the integration over a period
  [[nodiscard]] bool stable() const { return modes.empty() || modes.front().exponent.real() <= resolution; }
};

/// Z(T) of Ż = A Z, Z(0) = 1: by as many steps of the Magnus method of sixth order (Blanes, Casas, Oteo & Ros 2009,
/// section 5.4), which takes constant coefficients exactly, whatever their frequencies.
Eigen::MatrixXd monodromy(const PeriodicMatrix& A, int steps);

/// From the monodromy matrix, with steps halved until it stays; `masses` weigh displacements, the upper half of z.
/// \throws std::domain_error where anything is not finite.
FloquetAnalysis floquet(const PeriodicMatrix& A, const Eigen::VectorXd& masses);

}  // namespace withy
