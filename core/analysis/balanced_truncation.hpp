/// \file
/// Smaller linear systems with nearly the same transfer function.
#pragma once

#include "withy/core/analysis/linear_system.hpp"

namespace withy {

struct Reduction {
  LinearSystem system;     ///< balanced: its states have no other meaning
  Eigen::Index kept = 0;   ///< states that do not decay, which stay as they are
  Eigen::VectorXd hankel;  ///< Hankel singular values σ of the part that decays, greatest first
  double bound = 0;        ///< 2 Σ σ of what is left out: no frequency's value is off by more (Glover 1984)
};

/// Balanced truncation (Moore 1981) to `order` states, or to those that do not decay where they are more: the part that
/// decays is brought, by its Gramians, into states that are driven as well as they are seen, and the least are left
/// out. The parts are told apart by the matrix sign function (Roberts 1971). Sampled systems go there and back by the
/// bilinear transformation, which keeps σ.
/// \throws std::domain_error where A is not finite or the parts cannot be told apart
Reduction balanced_truncation(const LinearSystem& system, Eigen::Index order);

}  // namespace withy
