/// \file
/// Implicit Runge–Kutta methods of three stages by collocation (Radau IIA, Gauss), and the simplified Newton iteration
/// for their stages after Hairer & Wanner, "Solving Ordinary Differential Equations II", IV.8.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <span>

#include "jacobian.hpp"

namespace withy {

/// Coefficients from the nodes c: a_ij = ∫₀^{c_i} l_j, b_j = ∫₀¹ l_j with Lagrange's polynomials l_j, and the
/// transformation A⁻¹ T = T Λ, Λ = diag(γ, [[α, β], [−β, α]]). `A_rest` and `b_rest` are what doubles lose of A and b,
/// `by_stages` is A⁻ᵀ b.
struct Collocation {
  /// Nodes at the zeros of Legendre's polynomial: order 6, symplectic.
  static const Collocation& gauss();
  /// Nodes (4 ∓ √6)/10 and 1: order 5, L-stable.
  static const Collocation& radau_iia();

  Eigen::Vector3d c, b, b_rest, by_stages;
  Eigen::Matrix3d A, A_rest, T, T_inverse;
  double gamma = 0, alpha = 0, beta = 0;
};

/// The stages Y_i = y + z_i, z_i = h Σ a_ij f(t + c_j h, Y_j), of one step.
class CollocationStages {
 public:
  CollocationStages(const Collocation& method, StepJacobian& jacobian);

  enum class End { converged, slow, failed };
  struct Result {
    End end = End::failed;
    Evaluation evaluation;
    int iterations = 0;
    double rate = 0;  ///< of convergence
  };

  /// Factors for steps h; nothing where they are there.
  void factorize(double h);
  /// The Jacobian is another.
  void refactorize() { factored_ = 0; }

  /// First guess: the last step's polynomial, extrapolated; zero where there is none, and then nothing is known of how
  /// the iteration contracts.
  void predict(double h);
  /// First guess: straight on along the slope where the step begins.
  void predict_along(double h, const Eigen::ArrayXd& slope);
  /// z at fraction theta of the step is Σ weight_i z_i.
  [[nodiscard]] Eigen::Vector3d weights_at(double theta) const;

  /// Iterates from the prediction until the change of the stages, times what is to come of it, is below 1 in the
  /// greatest |Δz_i| / tolerance_i. Factors for h must be there.
  template <class Values, class Evaluate>
  Result solve(double t, double h, const Values& y, const Eigen::ArrayXd& tolerance, int most, Evaluate&& evaluate) {
    Result r;
    w_.noalias() = z_ * method_.T_inverse.transpose();
    double last_change = 0, factor = std::pow(std::max(contraction_, 1e-16), 0.8);
    for (r.iterations = 1; r.iterations <= most; ++r.iterations) {
      r.evaluation = evaluate_stages(t, h, y, evaluate);
      if (!r.evaluation.ok()) return r;
      correct(h, false);
      const double change = this->change(tolerance);
      if (!std::isfinite(change)) return nonfinite(r);
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
      r.evaluation = evaluate_stages(t, h, y, evaluate);
      if (!r.evaluation.ok()) return r;
      correct(h, true);
      const double change = this->change(tolerance);
      if (!std::isfinite(change)) return nonfinite(r);
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

  /// What stages that were iterated to rounding give at the end of the step: next + lost_next for y + lost, to more
  /// digits than doubles have. The iteration comes to rest on the side it comes from, which adds up over many steps: so
  /// what it leaves, r_i = y + lost + h Σ a_ij f_j − Y_i with stages Y_i as they were rounded, is taken in long
  /// doubles, and d − h A J d = r adds h Σ b_i J d_i = bᵀ A⁻¹ (d − r).
  void end_of_step(double h, std::span<const double> y, const Eigen::ArrayXd& lost, Eigen::ArrayXd& next,
                   Eigen::ArrayXd& lost_next);

  void accept(double h) { last_ = h; }
  void forget();
  void remember(Memory& memory);

  [[nodiscard]] const Eigen::MatrixXd& z() const { return z_; }
  /// f at the stages, the last iteration's.
  [[nodiscard]] const Eigen::MatrixXd& slopes() const { return slopes_; }
  [[nodiscard]] const ShiftedSystem<double>& real_system() const { return real_; }

 private:
  static Result nonfinite(Result r) {
    r.evaluation = {Evaluation::Outcome::nonfinite, -1};
    return r;
  }
  /// The stages' slopes.
  template <class Values, class Evaluate>
  Evaluation evaluate_stages(double t, double h, const Values& y, Evaluate&& evaluate) {
    for (int i = 0; i < 3; ++i) {
      stage_ = y;
      stage_.head(jacobian_.size()) += z_.col(i).array();
      const Evaluation evaluation = evaluate(t + method_.c[i] * h, stage_, slope_);
      if (!evaluation.ok()) return evaluation;
      slopes_.col(i) = slope_.matrix();
    }
    return {};
  }
  /// One simplified Newton iteration with these slopes: of z − h A f where `from_residual`, else of w.
  void correct(double h, bool from_residual);
  /// right_ to the solutions of both systems.
  void solve_transformed();
  /// right_: what takes residual_ away, in the coordinates of Λ.
  void solve_residual(double h);
  /// Greatest |Δz_i| / tolerance_i of the last iteration; infinite where a stage is not finite.
  double change(const Eigen::ArrayXd& tolerance);

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
