/// \file
/// Natural modes of small motions about a state: M δ̈ + G δ̇ + K δ = 0 with the exact derivatives, none of the matrices
/// symmetric in general (damping, spin, strict formulations).
#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

/// A pair of eigenvalues λ of motions e^{λt}: conjugate, or two real ones with the same shape. Where loads have
/// continuous states a real eigenvalue is a mode by itself: there is no telling which two belong together.
struct Mode {
  std::complex<double> eigenvalue;  ///< [1/s] the one with the greater real part; imaginary part ≥ 0
  std::complex<double> partner;     ///< its conjugate, or the other real eigenvalue; of one by itself the same
  bool single = false;              ///< a real eigenvalue by itself
  /// Displacements δ, one a speed, zero where held, then the continuous states of loads; the component that dominates
  /// is 1. Dimensions of the coordinates and states.
  Eigen::VectorXcd shape;
  Eigen::VectorXd shares;  ///< of the kinetic energy, as kinetic_shares of `shape`
  /// Speed with the greatest share. With continuous states of loads, which come behind the speeds, what takes
  /// part most: the greatest |w_i z_i|, w the left and z the right eigenvector of the first-order form (participation
  /// factors of Pérez-Arriaga, Verghese & Schweppe 1982), of a displacement with that of its rate.
  Eigen::Index dominant = 0;
  /// The same for a partner that is real: its motion has a shape of its own.
  Eigen::Index partner_dominant = 0;
  bool rigid = false;  ///< zero but for rounding: a motion that nothing holds back

  /// λ₁ λ₂ [1/s²]: the squared frequency; negative where the pair is real and of two signs. It passes smoothly through
  /// zero where a mode buckles.
  [[nodiscard]] double squared_frequency() const { return (eigenvalue * partner).real(); }
  [[nodiscard]] double frequency() const { return std::abs(eigenvalue); }  ///< undamped natural frequency [rad/s]
  [[nodiscard]] double growth() const { return eigenvalue.real(); }        ///< [1/s]
  /// What rounding may leave of the growth [1/s], `greatest` being the greatest |λ| of all modes: 1e-10 of that, and of
  /// one that is far slower, which is found with digits of its own, 1e-6 of its own |λ|.
  [[nodiscard]] double resolution(double greatest) const {
    return std::min(1e-10 * greatest, 1e-6 * std::abs(eigenvalue));
  }
  /// −Re λ/|λ|; meaningless for a rigid mode.
  [[nodiscard]] double damping_ratio() const { return -eigenvalue.real() / std::abs(eigenvalue); }
};

/// All modes of the free speeds and of the continuous states of loads, those that grow first, then in the order of the
/// smaller |λ| of each pair.
/// \throws std::domain_error where the mass matrix of the free speeds is singular or anything is not finite.
std::vector<Mode> natural_modes(const Tangents& tangents, const Held& held);

/// Shares of the kinetic energy of a shape: Re(δ̄_i (M δ)_i)/δᴴMδ of its speeds, which are first, and zero of what comes
/// behind them. They add up to 1; one is negative where a coordinate moves against the momentum that the others give
/// it. Where δᴴMδ is not positive, as of strict formulations that have broken down, those of each coordinate alone,
/// |δ_i|² |M_ii|; all are zero where nothing moves.
/// \param mass M, one row a speed
Eigen::VectorXd kinetic_shares(const Eigen::MatrixXd& mass, const Eigen::VectorXcd& shape);

/// Likeness of two shapes, |aᴴ W b|²/(aᴴ W a · bᴴ W b), W diagonal: 1 where they are proportional (modal assurance
/// criterion).
double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b, const Eigen::VectorXd& weights);

/// First-order form of small motions, z = (δ, δu) of the free speeds: ż = A z + B τ with efforts τ on all speeds.
struct FirstOrderForm {
  Eigen::MatrixXd A;  ///< 2m × 2m
  Eigen::MatrixXd B;  ///< 2m × speeds; columns of held speeds are zero
};

/// \throws std::domain_error as natural_modes.
FirstOrderForm first_order_form(const Tangents& tangents, const Held& held);

/// The same with the continuous states of loads behind the rates, z = (δ, δu, states of loads).
/// \throws std::domain_error as natural_modes.
FirstOrderForm whole_first_order_form(const Tangents& tangents, const Held& held);

/// Units of z in which inertias are one and both halves of A are alike, and the continuous states of loads, where A has
/// rows for them, like the others: eigenvalues of units A units⁻¹ are found as well as can be.
Eigen::VectorXd balancing_units(const Eigen::MatrixXd& A, const Eigen::VectorXd& masses);

}  // namespace withy
