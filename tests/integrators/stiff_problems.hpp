/// \file
/// Stiff test equations with known solutions.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "withy/tests/conformance/function_equations.hpp"

namespace withy {

/// Equations in positions alone with a linear part Ω that linearly implicit methods may solve with: two of them, of
/// which the second is idle where Ω is a number.
class StiffEquations : public FunctionEquations {
 public:
  StiffEquations(const Eigen::Matrix2d& linear, Function f) : FunctionEquations(2, 0, std::move(f)), linear_(linear) {}
  Work make_factors() const override { return Work(64); }
  Evaluation factorize(std::span<const double>, double delta, Work& factors) const noexcept override {
    const Eigen::Matrix2d inverse = (Eigen::Matrix2d::Identity() - delta * linear_).inverse();
    std::copy_n(inverse.data(), 4, reinterpret_cast<double*>(factors.data()));
    return {};
  }
  void solve(std::span<double> r, Work& factors) const noexcept override {
    const Eigen::Map<const Eigen::Matrix2d> inverse(reinterpret_cast<const double*>(factors.data()));
    const Eigen::Vector2d z = inverse * Eigen::Vector2d(r[0], r[1]);
    r[0] = z[0], r[1] = z[1];
  }
  // k = f(t, y) + Ω (base + δ k − y)
  Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                  std::span<double> y_dot, Work& work) const noexcept override {
    const Evaluation evaluation = derivatives(t, y, y_dot, work);
    const Eigen::Vector2d f(y_dot[0], y_dot[1]), off(base[0] - y[0], base[1] - y[1]);
    const Eigen::Vector2d k = (Eigen::Matrix2d::Identity() - delta * linear_).inverse() * (f + linear_ * off);
    y_dot[0] = k[0], y_dot[1] = k[1];
    return evaluation;
  }

 private:
  Eigen::Matrix2d linear_;
};

/// y′ = λ (y − sin t) + cos t, y = sin t (Prothero & Robinson 1974).
inline StiffEquations prothero_robinson(double lambda) {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Zero();
  linear(0, 0) = lambda;
  return {linear, [lambda](double t, std::span<const double> y, std::span<double> f) {
            f[0] = lambda * (y[0] - std::sin(t)) + std::cos(t);
            f[1] = f[2] = 0;
            return Evaluation{};
          }};
}

/// The nonlinear problem of Kværnø, Prothero & Robinson (Sandu, "A Class of Multirate Infinitesimal GARK Methods",
/// SIAM J. Numer. Anal. 57, 2019, section 6) with frequencies 5 and 1: u = √(3 + cos 5t), v = √(2 + cos t).
struct Kpr {
  static StiffEquations equations(double lambda) {
    constexpr double slow = -1, part = 0.1;
    Eigen::Matrix2d linear;
    linear << lambda, (1 - part) * (lambda - slow), -part * (lambda - slow), slow;
    return {linear, [linear](double t, std::span<const double> y, std::span<double> f) {
              const Eigen::Vector2d off((-3 + y[0] * y[0] - std::cos(5 * t)) / (2 * y[0]),
                                        (-2 + y[1] * y[1] - std::cos(t)) / (2 * y[1]));
              const Eigen::Vector2d rate = linear * off;
              f[0] = rate[0] - 5 * std::sin(5 * t) / (2 * y[0]);
              f[1] = rate[1] - std::sin(t) / (2 * y[1]);
              f[2] = 0;
              return Evaluation{};
            }};
  }
  static State start() { return {0, {2, std::sqrt(3.0), 0}}; }
  static double error(double t, std::span<const double> y) {
    return std::max(std::abs(y[0] - std::sqrt(3 + std::cos(5 * t))), std::abs(y[1] - std::sqrt(2 + std::cos(t))));
  }
};

/// ẍ = −k (x − sin t) − sin t, x = sin t: the same for methods of second-order equations.
inline FunctionEquations stiff_oscillator(double k) {
  return {1, 1, [k](double t, std::span<const double> y, std::span<double> f) {
            f[0] = y[1];
            f[1] = -k * (y[0] - std::sin(t)) - std::sin(t);
            f[2] = 0;
            return Evaluation{};
          }};
}

}  // namespace withy
