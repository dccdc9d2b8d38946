/// \file
/// Implicit Runge–Kutta methods of three stages by collocation (Radau IIA, Gauss), and the simplified Newton iteration
/// for their stages after Hairer & Wanner, "Solving Ordinary Differential Equations II", IV.8.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <complex>

#include "jacobian.hpp"

namespace withy {

/// Coefficients from the nodes c: a_ij = ∫₀^{c_i} l_j, b_j = ∫₀¹ l_j with Lagrange's polynomials l_j, and the
/// transformation A⁻¹ T = T Λ, Λ = diag(γ, [[α, β], [−β, α]]). `A_rest` and `b_rest` are what doubles lose of A and b.
struct Collocation {
  explicit Collocation(const std::array<long double, 3>& nodes) {
    for (int j = 0; j < 3; ++j) {
      c[j] = static_cast<double>(nodes[static_cast<std::size_t>(j)]);
      // l_j = (t − p)(t − q)/((c_j − p)(c_j − q)), integrated.
      const long double p = nodes[static_cast<std::size_t>((j + 1) % 3)],
                        q = nodes[static_cast<std::size_t>((j + 2) % 3)];
      const long double at = nodes[static_cast<std::size_t>(j)];
      const auto integral = [&](long double t) {
        return t * (t * t / 3 - (p + q) * t / 2 + p * q) / ((at - p) * (at - q));
      };
      const auto split = [](long double exact, double& value, double& rest) {
        value = static_cast<double>(exact);
        rest = static_cast<double>(exact - value);
      };
      for (int i = 0; i < 3; ++i) split(integral(nodes[static_cast<std::size_t>(i)]), A(i, j), A_rest(i, j));
      split(integral(1), b[j], b_rest[j]);
    }
    const Eigen::EigenSolver<Eigen::Matrix3d> eigen(A.inverse());
    int real = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(eigen.eigenvalues()[i].imag()) < std::abs(eigen.eigenvalues()[real].imag())) real = i;
    }
    int pair = real == 0 ? 1 : 0;
    gamma = eigen.eigenvalues()[real].real();
    const std::complex<double> lambda = eigen.eigenvalues()[pair];
    alpha = lambda.real();
    beta = lambda.imag();
    T << eigen.eigenvectors().col(real).real(), eigen.eigenvectors().col(pair).real(),
        eigen.eigenvectors().col(pair).imag();
    T_inverse = T.inverse();
  }

  Eigen::Vector3d c, b, b_rest;
  Eigen::Matrix3d A, A_rest, T, T_inverse;
  double gamma = 0, alpha = 0, beta = 0;
};

/// The stages Y_i = y + z_i, z_i = h Σ a_ij f(t + c_j h, Y_j), of one step.
class CollocationStages {
 public:
  CollocationStages(const Collocation& method, StepJacobian& jacobian)
      : method_(method), jacobian_(jacobian), real_(jacobian), complex_(jacobian) {
    const Eigen::Index m = jacobian.size();
    for (Eigen::MatrixXd* a : {&z_, &before_, &w_, &right_, &residual_}) a->setZero(m, 3);
    slopes_.setZero(jacobian.all(), 3);
    stage_.setZero(jacobian.all());
    slope_.setZero(jacobian.all());
    real_part_.setZero(m);
    complex_part_.setZero(m);
  }

  enum class End { converged, slow, failed };
  struct Result {
    End end = End::failed;
    Evaluation evaluation;
    int iterations = 0;
    double rate = 0;  ///< of convergence
  };

  /// Factors for steps h; nothing where they are there.
  void factorize(double h) {
    if (h == factored_) return;
    factored_ = h;
    real_.factorize(method_.gamma / h);
    complex_.factorize(std::complex<double>(method_.alpha, -method_.beta) / h);
  }
  /// The Jacobian is another.
  void refactorize() { factored_ = 0; }

  /// First guess: the last step's polynomial, extrapolated; zero where there is none.
  void predict(double h) {
    if (!(last_ > 0)) {
      z_.setZero();
      return;
    }
    // The polynomial through 0 and z_i at 0 and c_i of the last step, from its end on.
    before_ = z_;
    const Eigen::Vector3d end = weights_at(1);
    for (int i = 0; i < 3; ++i) z_.col(i).noalias() = before_ * (weights_at(1 + method_.c[i] * h / last_) - end);
  }
  /// z at fraction theta of the step is Σ weight_i z_i.
  [[nodiscard]] Eigen::Vector3d weights_at(double theta) const {
    Eigen::Vector3d weights;
    for (int i = 0; i < 3; ++i) {
      weights[i] = theta / method_.c[i];
      for (int j = 0; j < 3; ++j)
        if (j != i) weights[i] *= (theta - method_.c[j]) / (method_.c[i] - method_.c[j]);
    }
    return weights;
  }

  /// Iterates from the prediction until the change of the stages, times what is to come of it, is below 1 in the
  /// greatest |Δz_i| / tolerance_i. Factors for h must be there.
  template <class Values, class Evaluate>
  Result solve(double t, double h, const Values& y, const Eigen::ArrayXd& tolerance, int most, Evaluate&& evaluate) {
    Result r;
    w_.noalias() = z_ * method_.T_inverse.transpose();
    double last_change = 0, factor = std::pow(std::max(contraction_, 1e-16), 0.8);
    for (r.iterations = 1; r.iterations <= most; ++r.iterations) {
      const double change = iterate<false>(t, h, y, tolerance, evaluate, r.evaluation);
      if (!r.evaluation.ok()) return r;
      if (r.iterations > 1) {
        r.rate = change / last_change;
        factor = r.rate / (1 - r.rate);
        if (r.rate >= 0.99 || factor * change * std::pow(r.rate, most - 1 - r.iterations) > 1) break;
      }
      last_change = std::max(change, std::numeric_limits<double>::min());
      if (factor * change <= 1) {
        contraction_ = factor;
        r.end = End::converged;
        return r;
      }
    }
    r.end = End::slow;
    return r;
  }

  /// Iterates until the change is below 1, or below 1e4 and no longer shrinks: rounding is all that is left. The stages
  /// are those of A to its last digit, not of T Λ T⁻¹ in doubles, whose errors would add up to a drift of the energy in
  /// proportion to time (Hairer, McLachlan & Razakarivony, BIT 48, 2008).
  template <class Values, class Evaluate>
  Result solve_to_rounding(double t, double h, const Values& y, const Eigen::ArrayXd& tolerance, int most,
                           Evaluate&& evaluate) {
    Result r;
    double last_change = std::numeric_limits<double>::infinity();
    for (r.iterations = 1; r.iterations <= most; ++r.iterations) {
      const double change = iterate<true>(t, h, y, tolerance, evaluate, r.evaluation);
      if (!r.evaluation.ok()) return r;
      if (change <= 1 || (change >= last_change && change < 1e4)) {
        r.end = End::converged;
        return r;
      }
      if (r.iterations > 4 && change > 2 * last_change) break;
      last_change = change;
    }
    r.end = End::slow;
    return r;
  }

  void accept(double h) { last_ = h; }
  void forget() {
    last_ = 0;
    contraction_ = 1;
    factored_ = 0;
  }
  void remember(Memory& memory) {
    memory(last_);
    memory(contraction_);
    for (Eigen::Index i = 0; i < z_.size(); ++i) memory(z_(i));
    if (memory.reading()) factored_ = 0;
  }

  [[nodiscard]] const Eigen::MatrixXd& z() const { return z_; }
  /// f at the stages, the last iteration's.
  [[nodiscard]] const Eigen::MatrixXd& slopes() const { return slopes_; }
  ShiftedSystem<double>& real_system() { return real_; }

 private:
  /// One simplified Newton iteration; its greatest |Δz_i| / tolerance_i. `from_residual`: of z − h A f, else of w.
  template <bool from_residual, class Values, class Evaluate>
  double iterate(double t, double h, const Values& y, const Eigen::ArrayXd& tolerance, Evaluate&& evaluate,
                 Evaluation& evaluation) {
    const Eigen::Index m = jacobian_.size();
    for (int i = 0; i < 3; ++i) {
      stage_ = y;
      stage_.head(m) += z_.col(i).array();
      evaluation = evaluate(t + method_.c[i] * h, stage_, slope_);
      if (!evaluation.ok()) return 0;
      slopes_.col(i) = slope_.matrix();
    }
    if constexpr (from_residual) {
      residual_.noalias() = slopes_.topRows(m) * method_.A.transpose();
      residual_.noalias() += slopes_.topRows(m) * method_.A_rest.transpose();
      residual_ = h * residual_ - z_;
      w_.noalias() = residual_ * method_.T_inverse.transpose();
      right_.col(0) = method_.gamma / h * w_.col(0);
      right_.col(1) = (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
      right_.col(2) = (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
    } else {
      right_.noalias() = slopes_.topRows(m) * method_.T_inverse.transpose();
      right_.col(0) -= method_.gamma / h * w_.col(0);
      right_.col(1) -= (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
      right_.col(2) -= (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
    }
    real_part_ = right_.col(0);
    real_.solve(real_part_);
    complex_part_.real() = right_.col(1);
    complex_part_.imag() = right_.col(2);
    complex_.solve(complex_part_);
    right_.col(0) = real_part_;
    right_.col(1) = complex_part_.real();
    right_.col(2) = complex_part_.imag();
    if constexpr (from_residual) {
      z_.noalias() += right_ * method_.T.transpose();
    } else {
      w_ += right_;
      z_.noalias() = w_ * method_.T.transpose();
    }
    double change = 0;
    for (int i = 0; i < 3; ++i) {
      slope_.head(m) = (right_ * method_.T.row(i).transpose()).array().abs() / tolerance.head(m);
      if (!std::isfinite(slope_.head(m).sum())) evaluation = {Evaluation::Outcome::nonfinite, -1};
      change = std::max(change, slope_.head(m).maxCoeff());
    }
    return change;
  }

  const Collocation& method_;
  StepJacobian& jacobian_;
  ShiftedSystem<double> real_;
  ShiftedSystem<std::complex<double>> complex_;
  double factored_ = 0, last_ = 0;  ///< steps [s]: that of the factors, that of z_
  double contraction_ = 1;
  Eigen::MatrixXd z_, before_, w_, right_, residual_, slopes_;
  Eigen::ArrayXd stage_, slope_;
  Eigen::VectorXd real_part_;
  Eigen::VectorXcd complex_part_;
};

}  // namespace withy
