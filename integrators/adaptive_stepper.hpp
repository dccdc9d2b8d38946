/// \file
/// Step size control for one-step methods with an error estimate O(h⁵), or of another power of h: automatic first step
/// and PI control after Hairer, Nørsett & Wanner, "Solving Ordinary Differential Equations I", II.4 and IV.2 (II).
#pragma once

#include "one_step.hpp"
#include "step_control.hpp"

namespace withy {

class AdaptiveStepper : public OneStep {
 public:
  /// \param caution by which estimates are multiplied: chosen so that a run over some vibrations, in which the errors
  /// of steps add up, ends within ten times its tolerance
  AdaptiveStepper(const EquationsOfMotion& equations, const State& start, const StepControl& control,
                  int error_order = 5, double caution = 1, double safety = 0.9)
      : OneStep(equations, start),
        error_(Eigen::ArrayXd::Zero(size())),
        counted_(size() - (nothing_free(equations.layout()) ? 0 : 1)),
        control_(control),
        caution_(caution),
        safety_(safety),
        error_root_(1.0 / error_order),
        error_power_(error_root_ - 0.75 * stabilization) {}

  StepResult step(double t_limit) final {
    const double t = state_.time;
    if (!(t_limit > t)) return {};
    if (const StepResult r = begin(t_limit); r.outcome != StepResult::Outcome::ok) return r;
    const double remaining = t_limit - t;
    const double least = std::max({control_.min_step, 16 * std::numeric_limits<double>::epsilon() * std::abs(t),
                                   std::numeric_limits<double>::min()});
    // What remains may be a rounding error long: the first step, found as a part of it, is no shorter than any may be,
    // the next one neither, when the least is a rounding error longer.
    if (!(proposal_ > 0))
      proposal_ = control_.initial_step > 0 ? control_.initial_step : std::max(first_step(remaining), 2 * least);
    double wanted = std::min(proposal_, control_.max_step);
    bool rejected = false;
    for (int failures = 0;;) {
      if (wanted < least && wanted < remaining) return {StepResult::Outcome::step_underflow, -1};
      const double fitted = fit(wanted, remaining);
      const double t_new = fitted < remaining ? std::min(t + fitted, t_limit) : t_limit;
      const double h = t_new - t;
      const Trial trial = attempt(h);
      if (!trial.evaluation.ok() || !std::isfinite(trial.error) || !finite(next_, next_slope_)) {
        // Where halving stops is a matter of the equations, not of the accuracy asked for.
        ++statistics_.rejected;
        wanted = h / 2;
        rejected = true;
        accuracy_to_blame_ = std::max(accuracy_to_blame_ - 1, -10);
        // At a pole of the right-hand side a stage may hit the pole itself: the accuracy had ended the run anyway.
        if (wanted < least && accuracy_to_blame_ > 0) return {StepResult::Outcome::step_underflow, -1};
        if (++failures == most_failures || wanted < least) return failure(trial.evaluation);
        continue;
      }
      failures = 0;
      const double growth = std::pow(trial.error, error_power_);
      if (trial.error > 1) {
        ++statistics_.rejected;
        wanted = h / std::min(greatest_reduction, growth / safety_);
        rejected = true;
        accuracy_to_blame_ = std::min(accuracy_to_blame_ + 1, 10);
        continue;
      }
      const double factor = growth / std::pow(error_before_, stabilization) / safety_;
      double next_step = h / std::clamp(factor, 1 / greatest_growth, greatest_reduction);
      if (rejected) next_step = std::min(next_step, h);
      next_step = favoured(next_step, h);
      // A step cut short to land says nothing against the step that was wanted.
      proposal_ = h < wanted ? std::max(wanted, next_step) : next_step;
      error_before_ = std::max(trial.error, 1e-4);
      accept(t_new);
      accepted(h);
      return {};
    }
  }

  void restart() override {
    OneStep::restart();
    proposal_ = 0;
    error_before_ = 1e-4;
  }

 protected:
  void remember(Memory& memory) override {
    OneStep::remember(memory);
    memory(proposal_);
    memory(error_before_);
    memory(accuracy_to_blame_);
  }

  struct Trial {
    Evaluation evaluation;
    double error = 0;  ///< greatest error over tolerance; above 1 the step is rejected
  };

  /// Tries a step h from state_ with slope_: fills error_, next_ (normalized) and, unless the error is above 1,
  /// next_slope_.
  virtual Trial attempt(double h) = 0;
  /// Called after state_, slope_ and their predecessors are those of an accepted step h: keeps what `inside` needs.
  virtual void accepted(double h) = 0;

  /// The step to take where control wants `wanted` after an accepted step h.
  [[nodiscard]] virtual double favoured(double wanted, double /*h*/) const { return wanted; }

  /// Greatest of caution |error_| / (atol + rtol max(|y|, |next_|)) over positions and speeds, and the work where it
  /// counts. The greatest, not the mean: a coordinate's error does not hide behind the number of the others.
  [[nodiscard]] double error_ratio() const {
    const Eigen::Index n = counted_;
    const auto ratio =
        error_.head(n).abs() / (control_.atol + control_.rtol * y().head(n).abs().max(next_.head(n).abs()));
    if (n == 0) return 0;
    const double greatest = ratio.maxCoeff<Eigen::PropagateNaN>();
    return std::isfinite(greatest) ? caution_ * greatest : std::numeric_limits<double>::quiet_NaN();
  }

  /// Whether the error of the work is among those that error_ratio() looks at.
  [[nodiscard]] bool work_counts() const { return counted_ == size(); }

  Eigen::ArrayXd error_;  ///< estimated error of next_

 private:
  static constexpr int most_failures = 20;
  static constexpr double stabilization = 0.04;
  static constexpr double greatest_reduction = 5;
  static constexpr double greatest_growth = 10;

  /// The step to take where `wanted` is wanted: stretched by at most 1 % to land, or half of what remains where the
  /// step after it would be a short one.
  static double fit(double wanted, double remaining) {
    if (remaining <= 1.01 * wanted) return remaining;
    return remaining < 2 * wanted ? remaining / 2 : wanted;
  }

  /// The first step after HNW I, II.4, with its bounds made free of the unit of time: h0, for which an explicit Euler
  /// step changes y by 1 %, tells how fast the slope changes; from that time τ follows the step whose error, of the
  /// estimate's order, is about a hundredth of the tolerance. Half of it: at the start from rest motion is even in
  /// time, and estimates may miss a first step's error by a factor of a hundred.
  double first_step(double remaining) {
    const Eigen::Index n = counted_;
    if (n == 0) return remaining;
    const auto norm = [&](const auto& v) {
      return (v.head(n).abs() / (control_.atol + control_.rtol * y().head(n).abs())).maxCoeff();
    };
    const double fallback = 1e-6 * remaining;
    const double d0 = norm(y());
    const double d1 = norm(slope_);
    const double h0 = std::min(d0 < 1e-5 || d1 * remaining < 1e-5 ? fallback : 0.01 * d0 / d1, remaining);
    if (!(h0 > 0)) return fallback;
    next_ = y() + h0 * slope_;
    normalize(next_);
    if (!evaluate(state_.time + h0, next_, next_slope_).ok() || !finite(next_slope_)) return std::min(h0, fallback);
    const double d2 = norm(next_slope_ - slope_) / h0;
    const double longest = std::min(100 * h0, remaining);
    if (!(d2 > 0)) return longest;
    const double tau = std::max(d1 / d2, h0);
    return 0.25 * std::min(tau * std::pow(0.01 / (d2 * tau * tau), error_root_), longest);
  }

  /// Whether motions prescribe every speed: then the work is all that there is to integrate.
  static bool nothing_free(const Layout& layout) { return layout.speeds > 0 && layout.prescribed == layout.speeds; }

  Eigen::Index counted_;  ///< elements of y whose errors count, from the first on
  StepControl control_;
  double caution_, safety_;
  double error_root_;    ///< 1 / order of the error estimate
  double error_power_;   ///< of the controller
  double proposal_ = 0;  ///< [s], the next step; 0: to be found
  double error_before_ = 1e-4;
  int accuracy_to_blame_ = 0;  ///< the last rejections: more for the error (above 0) or for failures (below)
};

/// The integrator whose steppers are `Method`, which states its order and its limit on the imaginary axis.
template <class Method>
class Controlled final : public Integrator {
 public:
  explicit Controlled(const StepControl& control) : control_(control) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<Method>(equations, state, control_);
  }
  int order() const override { return Method::order; }
  std::optional<double> stability_limit() const override { return Method::stability_limit; }

 private:
  StepControl control_;
};

/// Reads checked parameters; null after a reported error.
template <class Method>
std::unique_ptr<Integrator> make_controlled(const Value& p, const MakeContext& context) {
  const std::optional<StepControl> control = read_step_control(p, context);
  return control ? std::make_unique<Controlled<Method>>(*control) : nullptr;
}

}  // namespace withy
