/// \file
/// A transfer function over frequencies: its resonances, and how far the loop that it closes is from instability.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "withy/core/analysis/linear_system.hpp"

namespace withy {

/// One value of a transfer function.
struct ResponseAt {
  double omega = 0;  ///< [rad/s]
  std::complex<double> value;
};

/// Values from `low` to `high` [rad/s]: `per_decade` at equal ratios and, about each pole and zero that is little
/// damped, some across its width, so that none is passed over. Of a sampled system to half its rate at most. A value
/// that is not finite, at an undamped pole, is left out.
/// \param marks poles and zeros; of a sampled system multipliers
std::vector<ResponseAt> frequency_response(const TransferFunction& G, double low, double high, int per_decade,
                                           const Eigen::VectorXcd& marks);

/// Whether the input reaches the output by more than rounding: whether near some pole |g₁₁ g₂₂| is more than 1e-12 of
/// |g₁₂ g₂₁|, g₁₁ being G and 2 a direction in which all states have a part. Whatever the units of input, output and
/// states are, two ends that symmetry keeps apart have less.
/// \param poles of the system; of a sampled one multipliers
bool is_felt(const LinearSystem& system, const Eigen::VectorXcd& poles);

/// Poles and zeros that are the same: motions that the input does not move or the output does not see.
struct SeenRoots {
  Eigen::VectorXcd poles, zeros;  ///< without them
  Eigen::VectorXcd hidden;
};
/// They are the same where they differ by no more than rounding of each may have moved it, or by 1e-6 of themselves.
SeenRoots seen_roots(const LinearSystem& system, const KnownRoots& poles, const KnownRoots& zeros);

/// Decay and frequency s = ln(z)/T that a multiplier stands for; an eigenvalue of a system in continuous time itself.
std::complex<double> exponent_of(const LinearSystem& system, std::complex<double> value);

/// A resonance: a maximum of |G|.
struct Peak {
  double omega = 0;              ///< [rad/s]
  std::optional<double> height;  ///< nothing at an undamped pole, where there is no bound
};
/// All within the response, in the order of frequency: found between its values by the golden section. `poles` that lie
/// on the edge of stability are peaks without a height.
std::vector<Peak> peaks(const TransferFunction& G, const std::vector<ResponseAt>& response,
                        const Eigen::VectorXcd& poles);

/// A gain k, or a phase, at which the loop v = −k y of a transfer function y = G v has a pole on the edge of stability.
struct GainMargin {
  double omega = 0;   ///< [rad/s] where G is real and negative; infinite: at v's own frequencies without bound
  double factor = 0;  ///< k > 0; above 1 the gain may grow by it, below 1 it may fall to it
};
struct PhaseMargin {
  double omega = 0;  ///< [rad/s] where |G| is 1
  double angle = 0;  ///< [rad] lag that brings the pole there, −π to π; negative: lead
  double delay = 0;  ///< [s] dead time that brings it there: angle mod 2π over ω
};
struct Margins {
  std::vector<GainMargin> gains;    ///< in the order of frequency
  std::vector<PhaseMargin> phases;  ///< in the order of frequency
  bool stable = false;              ///< whether all poles of the loop closed with k = 1 decay, and no hidden one grows
  double growth = 0;                ///< [1/s] of its pole that decays least, or of a hidden one that grows faster
  double hidden_growth = 0;         ///< [1/s] of the hidden pole that grows fastest, which no gain stops; 0: none grows
  double period = 0;                ///< [s] of a sampled system
  double last = 0;                  ///< |G| at the last frequency: infinity, or half the rate of a sampled system
  /// The nearest of `gains` to k = 1: the least of the factors above, the greatest below; null where there is none.
  [[nodiscard]] const GainMargin* upper() const;
  [[nodiscard]] const GainMargin* lower() const;
  /// Of a stable loop what makes it unstable: the least lag and the least lead below 180° that do, and the least dead
  /// time, at a frequency of its own. Null where none does, and of a loop that is not stable. Null too is the dead time
  /// where `last` is not below 1: in continuous time any is too much then.
  [[nodiscard]] const PhaseMargin* lag() const;
  [[nodiscard]] const PhaseMargin* lead() const;
  [[nodiscard]] const PhaseMargin* delay() const;
  /// Of a sampled loop with such a dead time, the whole samples below it: a delay of these leaves it stable. What is
  /// held between samples has another lag at a part of one.
  [[nodiscard]] std::optional<int> samples() const;
};
/// From the crossings of G with the negative real axis and the unit circle between the values of the response, found by
/// bisection, and from the ends of the frequencies: 0, and half the rate or infinity.
/// \param hidden poles that the loop does not move: of these only growth counts
/// \param static_gain G(0); nothing where that has no bound
/// \throws std::domain_error where the closed loop is not well posed
Margins margins(const TransferFunction& G, const std::vector<ResponseAt>& response, const Eigen::VectorXcd& hidden,
                std::optional<double> static_gain);

/// A of the loop v = −k y. \throws std::domain_error where 1 + k D is zero: the loop is not well posed
LinearSystem closed_loop(const LinearSystem& system, double k);

}  // namespace withy
