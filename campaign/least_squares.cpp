#include "withy/campaign/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>

namespace withy::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A coordinate z within bounds as a function of q without any.
class Bounds {
 public:
  Bounds(double lower, double upper) : lower_(lower), upper_(upper) {}
  [[nodiscard]] double z(double q) const {
    if (two()) return lower_ + (upper_ - lower_) / 2 * (std::sin(q) + 1);
    if (std::isfinite(lower_)) return lower_ - 1 + std::sqrt(q * q + 1);
    if (std::isfinite(upper_)) return upper_ + 1 - std::sqrt(q * q + 1);
    return q;
  }
  [[nodiscard]] double slope(double q) const {
    if (two()) return (upper_ - lower_) / 2 * std::cos(q);
    if (std::isfinite(lower_)) return q / std::sqrt(q * q + 1);
    if (std::isfinite(upper_)) return -q / std::sqrt(q * q + 1);
    return 1;
  }
  [[nodiscard]] double q(double z) const {
    constexpr double inside = 1e-3;
    const auto root = [](double x) { return std::sqrt(x * x - 1); };
    if (two()) return std::asin(std::clamp(2 * (z - lower_) / (upper_ - lower_) - 1, inside - 1, 1 - inside));
    if (std::isfinite(lower_)) return root(std::max(z - lower_, inside) + 1);
    if (std::isfinite(upper_)) return root(std::max(upper_ - z, inside) + 1);
    return z;
  }

 private:
  [[nodiscard]] bool two() const { return std::isfinite(lower_) && std::isfinite(upper_); }
  double lower_, upper_;
};

/// The problem in steps from the start in q, in the form that Eigen's method takes.
class FreeProblem {
 public:
  FreeProblem(const LeastSquaresProblem& problem, const VectorXd& start) : problem_(problem), origin_(start.size()) {
    for (Index i = 0; i < start.size(); ++i) {
      bounds_.emplace_back(problem.lower[i], problem.upper[i]);
      origin_[i] = bounds_.back().q(start[i]);
    }
  }
  [[nodiscard]] VectorXd z(const VectorXd& step) const {
    VectorXd at(step.size());
    for (Index i = 0; i < step.size(); ++i) at[i] = bounds_[static_cast<std::size_t>(i)].z(origin_[i] + step[i]);
    return at;
  }
  [[nodiscard]] int values() const { return static_cast<int>(problem_.residuals); }
  int operator()(const VectorXd& step, VectorXd& r) const {
    constexpr double rejected = 1e100;
    if (!problem_.evaluate(z(step), r)) r.setConstant(problem_.residuals, rejected);
    return problem_.interrupted && problem_.interrupted() ? -1 : 0;
  }
  int df(const VectorXd& step, MatrixXd& J) {
    no_derivatives = !problem_.derivatives(z(step), J);
    if (no_derivatives) return -1;
    for (Index i = 0; i < step.size(); ++i)
      J.col(i) *= bounds_[static_cast<std::size_t>(i)].slope(origin_[i] + step[i]);
    return problem_.interrupted && problem_.interrupted() ? -1 : 0;
  }

  bool no_derivatives = false;

 private:
  const LeastSquaresProblem& problem_;
  std::vector<Bounds> bounds_;
  VectorXd origin_;
};

}  // namespace

LeastSquaresResult least_squares(const LeastSquaresProblem& problem, const VectorXd& start) {
  namespace Space = Eigen::LevenbergMarquardtSpace;
  constexpr double tolerance = 1e-6;
  constexpr int most_trials = 200;
  FreeProblem free(problem, start);
  Eigen::LevenbergMarquardt<FreeProblem> method(free);
  method.parameters.ftol = method.parameters.xtol = tolerance;
  method.parameters.maxfev = most_trials;
  method.parameters.factor = 0.5;
  method.useExternalScaling = true;
  method.diag.setOnes(start.size());
  VectorXd step = VectorXd::Zero(start.size());
  const Space::Status status = method.minimize(step);
  LeastSquaresResult result;
  result.z = free.z(step);
  result.interrupted = problem.interrupted && problem.interrupted();
  result.converged = true;
  switch (status) {
    case Space::RelativeReductionTooSmall:
    case Space::RelativeErrorAndReductionTooSmall:
      result.reason = "a further step would lessen the sum of squares by less than a millionth";
      break;
    case Space::RelativeErrorTooSmall:
      result.reason = "steps have become smaller than a millionth of the way gone";
      break;
    case Space::CosinusTooSmall:
    case Space::FtolTooSmall:
    case Space::XtolTooSmall:
    case Space::GtolTooSmall:
      result.reason = "rounding leaves nothing to gain";
      break;
    case Space::TooManyFunctionEvaluation:
      result.converged = false;
      result.reason = "it has not converged within 200 trial steps";
      break;
    default:
      result.converged = false;
      result.reason = free.no_derivatives ? "runs beside the last point fail, so that there are no derivatives there"
                                          : "it was interrupted";
  }
  return result;
}

}  // namespace withy::campaign
