/// \file
/// The root of a rod in space whose modes turn it: R(0) = exp(θ̂) with θ = Σ ψ_i(0) q_i.
#pragma once

#include <cmath>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/sweep/node.hpp"
#include "withy/core/sweep/shared_numbers.hpp"

namespace withy::sweep {

/// At one state, in the axes of the node. With the left Jacobian L = 1 + b θ̂ + c θ̂² of the rotation group the partial
/// angular velocities are w_i = L ψ_i, and L̇ θ̇ remains of the angular acceleration at q̈ = 0.
class RootTurn {
 public:
  /// \param psi of each mode
  RootTurn(const SharedNumbers<Triple>& psi, int modes, const double* q, const double* q_dot)
      : theta_(sum(psi, modes, q)), rate_(sum(psi, modes, q_dot)), k_(dot(theta_, theta_)) {}

  /// w, x, y, z of R(0).
  [[nodiscard]] Pack quaternion() const {
    const double square = 0.25 * dot(theta_, theta_), sinc = withy::detail::ExponentialCoefficients<double>(square).a;
    const Triple v = theta_ * (0.5 * sinc);
    return Pack{std::cos(std::sqrt(square)), v[0], v[1], v[2]};
  }
  /// What w_i has beyond ψ_i: nothing where θ and ψ_i are parallel.
  [[nodiscard]] Triple beyond(const Triple& psi) const {
    const Triple x = cross(theta_, psi);
    return x * k_.b + cross(theta_, x) * k_.c;
  }
  [[nodiscard]] Triple bias() const {
    const Triple x = cross(theta_, rate_);
    const double square_rate = 2 * dot(theta_, rate_);
    return x * (k_.db * square_rate) + cross(theta_, x) * (k_.dc * square_rate) + cross(rate_, x) * k_.c;
  }

 private:
  static Triple sum(const SharedNumbers<Triple>& psi, int modes, const double* factors) {
    Triple v = Triple::zero();
    for (int i = 0; i < modes; ++i) v += psi[static_cast<std::size_t>(i)] * factors[i];
    return v;
  }

  Triple theta_, rate_;
  withy::detail::ExponentialCoefficients<double> k_;
};

}  // namespace withy::sweep
