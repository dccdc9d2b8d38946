/// \file
/// What the hinge plugins of this folder share.
#pragma once

#include "withy/core/plugin/direction.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// The parameter `axis` of a hinge with one axis.
inline std::vector<ParameterSpec> axis_parameter() {
  return {
      vector("axis", 3, "1", "axis, the same components in the hinge frames of parent and child; any length but zero")};
}

/// A direction as the default of a parameter.
inline Value direction(double x, double y, double z) { return Value::list({Value(x), Value(y), Value(z)}); }

/// Whether two unit vectors are within a microradian of one line: no plane then lies through both to any accuracy.
inline bool nearly_parallel(const Vector3& a, const Vector3& b) { return a.cross(b).norm() < 1e-6; }

/// The motion_derivative of a hinge with constant motion subspace and no bias.
inline void no_motion_derivative(const Hinge& hinge, HingeMotion& out) {
  out.H.setZero(6, static_cast<Eigen::Index>(hinge.speeds()));
  out.bias.setZero();
}

/// A hinge whose coordinates are the integrals of its rates: the part every such hinge shares.
class HolonomicHinge : public Hinge {
 public:
  std::size_t coordinates() const override { return speeds(); }
  void reference(std::span<double> x) const noexcept override {
    for (double& xi : x) xi = 0;
  }
  void derivatives(std::span<const double> /*x*/, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    for (std::size_t i = 0; i < rates.size(); ++i) x_dot[i] = rates[i];
  }
  void normalize(std::span<double> /*x*/) const noexcept override {}
};

/// ẇ of a unit quaternion (w x y z) of M in F from ω_FM in F: ½ (0, ω) ⊗ quaternion.
inline void quaternion_rates(std::span<const double> x, std::span<const double> omega, std::span<double> x_dot) {
  const double w = x[0], a = x[1], b = x[2], c = x[3];
  x_dot[0] = -0.5 * (omega[0] * a + omega[1] * b + omega[2] * c);
  x_dot[1] = 0.5 * (omega[0] * w + omega[1] * c - omega[2] * b);
  x_dot[2] = 0.5 * (omega[1] * w + omega[2] * a - omega[0] * c);
  x_dot[3] = 0.5 * (omega[2] * w + omega[0] * b - omega[1] * a);
}

/// Scales the quaternion in x[0..3] to unit length; a zero quaternion, which no rotation has, is left as it is.
inline void normalize_quaternion(std::span<double> x) {
  const double norm = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3] * x[3]);
  if (!(norm > 0)) return;
  for (std::size_t i = 0; i < 4; ++i) x[i] /= norm;
}

}  // namespace withy
