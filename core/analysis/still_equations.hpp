/// \file
/// What nothing holds of bodies together with loads that have states of their own.
#pragma once

#include "withy/core/analysis/steady_state.hpp"

namespace withy {

/// What sampled loads hold (d) in small motions.
struct HeldNumbers {
  Eigen::MatrixXd efforts;  ///< ∂τ/∂d, one row a speed
  Eigen::MatrixXd rates;    ///< rates of the continuous states of loads by d
  Eigen::MatrixXd renewed;  ///< d just after a sample by z = (δ of the free speeds, their rates, states, d) before it
};

/// Independent columns of z = (δ of the free speeds, their rates, the continuous states of loads, d) that stay as they
/// are: ż = 0 and, of what is held, d⁺ = d. They are found in the equations of equilibrium, in which each row is
/// measured by itself: beside what is a million times as fast, what is slow is no rounding.
Eigen::MatrixXd unheld_motions(const Tangents& tangents, const Held& held, const HeldNumbers& numbers = {});

}  // namespace withy
