/// \file
/// Runge–Kutta of order 4 with step doubling: each step is made once whole and once in two halves; their difference is
/// the error estimate and, added (local extrapolation), makes the result of order 5. Eleven evaluations a step.
#include "adaptive_stepper.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

class Rk4AdaptiveStepper final : public AdaptiveStepper {
 public:
  static constexpr int order = 5;
  static constexpr double stability_limit = 4.828;

  Rk4AdaptiveStepper(const EquationsOfMotion& equations, const State& start, const StepControl& control)
      : AdaptiveStepper(equations, start, control, 5, 4) {
    for (Eigen::ArrayXd* a :
         {&stage_, &k2_, &k3_, &k4_, &whole_, &middle_, &middle_slope_, &kept_middle_, &kept_middle_slope_})
      a->setZero(size());
  }

 private:
  Trial attempt(double h) override {
    const double t = state_.time;
    start_ = y();
    if (const Evaluation e = rk4(t, h, start_, slope_, whole_); !e.ok()) return {e};
    if (const Evaluation e = rk4(t, h / 2, start_, slope_, middle_); !e.ok()) return {e};
    if (const Evaluation e = evaluate(t + h / 2, middle_, middle_slope_); !e.ok()) return {e};
    if (const Evaluation e = rk4(t + h / 2, h / 2, middle_, middle_slope_, next_); !e.ok()) return {e};
    error_ = (next_ - whole_) / 15;
    next_ += error_;
    normalize(next_);
    Trial trial{{}, error_ratio()};
    if (trial.error <= 1) trial.evaluation = evaluate(t + h, next_, next_slope_);
    return trial;
  }

  Evaluation rk4(double t, double h, const Eigen::ArrayXd& from, const Eigen::ArrayXd& k1, Eigen::ArrayXd& to) {
    if (const Evaluation e = evaluate(t + h / 2, stage_ = from + h / 2 * k1, k2_); !e.ok()) return e;
    if (const Evaluation e = evaluate(t + h / 2, stage_ = from + h / 2 * k2_, k3_); !e.ok()) return e;
    if (const Evaluation e = evaluate(t + h, stage_ = from + h * k3_, k4_); !e.ok()) return e;
    to = from + h / 6 * (k1 + 2 * k2_ + 2 * k3_ + k4_);
    return {};
  }

  /// The half step's own error is half of error_, which both halves together make.
  void accepted(double /*h*/) override {
    kept_middle_ = middle_ + error_ / 2;
    kept_middle_slope_.swap(middle_slope_);
  }

  /// Quintic through values and slopes at both ends and the middle: error O(h⁶).
  void inside(double theta, Values values) const override {
    const double h = state_.time - previous_time_;
    const auto square = [](double x) { return x * x; };
    const double l0 = square(2 * (theta - 0.5) * (theta - 1));
    const double l1 = square(4 * theta * (1 - theta));
    const double l2 = square(2 * theta * (theta - 0.5));
    values = l0 * ((1 + 6 * theta) * previous_ + h * theta * previous_slope_) +
             l1 * (kept_middle_ + h * (theta - 0.5) * kept_middle_slope_) +
             l2 * ((7 - 6 * theta) * y() + h * (theta - 1) * slope_);
  }

  Eigen::ArrayXd start_, stage_, k2_, k3_, k4_;
  Eigen::ArrayXd whole_;                            ///< result of the whole step
  Eigen::ArrayXd middle_, middle_slope_;            ///< after the first half
  Eigen::ArrayXd kept_middle_, kept_middle_slope_;  ///< of the last accepted step, extrapolated
};

}  // namespace

void enroll_rk4_adaptive(Enrollment& enrollment) {
  enrollment.add<Integrator>({.id = "rk4-adaptive",
                              .summary = "Runge-Kutta of order 4 with step doubling and local extrapolation",
                              .parameters = step_control_parameters(),
                              .make = &make_controlled<Rk4AdaptiveStepper>});
}

}  // namespace withy
