#include "withy/campaign/least_squares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

namespace withy::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
namespace Space = Eigen::LevenbergMarquardtSpace;

constexpr double search_tolerance = 1e-6;
constexpr int most_trials = 200;

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
  int operator()(const VectorXd& step, VectorXd& r) {
    constexpr double rejected = 1e100;
    last_ = step;
    if (!problem_.evaluate(z(step), r)) {
      r.setConstant(problem_.residuals, rejected);
      failures_.push_back(step);
    }
    return problem_.interrupted && problem_.interrupted() ? -1 : 0;
  }
  int df(const VectorXd& step, MatrixXd& J) {
    no_derivatives = !problem_.derivatives(z(step), J);
    if (no_derivatives) return -1;
    for (Index i = 0; i < step.size(); ++i)
      J.col(i) *= bounds_[static_cast<std::size_t>(i)].slope(origin_[i] + step[i]);
    return problem_.interrupted && problem_.interrupted() ? -1 : 0;
  }

  /// Whether trials without residuals have held up a search that went on from `before` and ended here. After one of
  /// them steps are at the least a tenth as long, so that it lies within some lengths of the last trial.
  [[nodiscard]] bool held_up(const VectorXd& before, const VectorXd& here) const {
    constexpr double lengths = 20;
    const double near = lengths * (last_ - before).norm();
    return std::any_of(failures_.begin(), failures_.end(),
                       [&](const VectorXd& f) { return (f - here).norm() <= near; });
  }

  bool no_derivatives = false;

 private:
  const LeastSquaresProblem& problem_;
  std::vector<VectorXd> failures_;  ///< trials that had no residuals
  VectorXd last_;                   ///< trial
  std::vector<Bounds> bounds_;
  VectorXd origin_;
};

/// What the method says of its end; without the point.
LeastSquaresResult end_of_search(Space::Status status, bool no_derivatives) {
  switch (status) {
    case Space::RelativeReductionTooSmall:
    case Space::RelativeErrorAndReductionTooSmall:
      return {{}, true, false, "a further step would lessen the sum of squares by less than a millionth"};
    case Space::RelativeErrorTooSmall:
      return {{}, true, false, "steps have become smaller than a millionth of the way gone"};
    case Space::CosinusTooSmall:
    case Space::FtolTooSmall:
    case Space::XtolTooSmall:
    case Space::GtolTooSmall:
      return {{}, true, false, "rounding leaves nothing to gain"};
    case Space::TooManyFunctionEvaluation:
      return {{}, false, false, fmt::format("it has not converged within {} trial steps", most_trials)};
    default:
      return {{},
              false,
              false,
              no_derivatives ? "runs beside the last point fail, so that there are no derivatives there"
                             : "it was interrupted"};
  }
}

}  // namespace

LeastSquaresResult least_squares(const LeastSquaresProblem& problem, const VectorXd& start) {
  FreeProblem free(problem, start);
  Eigen::LevenbergMarquardt<FreeProblem> method(free);
  method.parameters.ftol = method.parameters.xtol = search_tolerance;
  method.parameters.maxfev = most_trials;
  method.parameters.factor = 0.5;
  method.useExternalScaling = true;
  method.diag.setOnes(start.size());
  VectorXd step = VectorXd::Zero(start.size());
  VectorXd before = step;
  Space::Status status = method.minimizeInit(step);
  while (status == Space::NotStarted || status == Space::Running) {
    before = step;
    status = method.minimizeOneStep(step);
  }
  LeastSquaresResult result = end_of_search(status, free.no_derivatives);
  result.z = free.z(step);
  result.interrupted = problem.interrupted && problem.interrupted();
  // Steps that failures keep short promise little, where one as long as the least squares ask for would lessen much.
  const bool promising = method.qtf.squaredNorm() > search_tolerance * method.fnorm * method.fnorm;
  if (result.converged && promising && free.held_up(before, step)) {
    result.converged = false;
    result.reason = "steps that would lessen the sum of squares further lead to runs that fail";
  }
  return result;
}

}  // namespace withy::campaign
