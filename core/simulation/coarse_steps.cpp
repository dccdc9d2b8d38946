#include "withy/core/simulation/coarse_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "withy/core/plugin/discrete_states.hpp"
#include "withy/core/plugin/just_before.hpp"

namespace withy {
namespace {

class SemiImplicitStepper final : public Stepper {
 public:
  SemiImplicitStepper(const EquationsOfMotion& equations, const LinearlyImplicit& linear, const State& start,
                      double step, const std::vector<double>& ends)
      : equations_(equations),
        linear_(linear),
        work_(equations.make_work()),
        step_(step),
        ends_(ends),
        state_(start),
        before_(start),
        stage_(start.y),
        base_(start.y),
        first_(start.y.size(), 0.0),
        slope_(start.y.size(), 0.0) {
    equations_.normalize(state_.y);
  }

  StepResult step(double t_limit) override {
    const double t = state_.time;
    if (!(t_limit > t)) return {};
    if (const auto end = std::upper_bound(ends_.begin(), ends_.end(), t); end != ends_.end())
      t_limit = std::min(t_limit, *end);
    const double left = std::ceil((t_limit - t) / step_ * (1 - 1e-9));  // the allowance: no step more by rounding
    const double t_new = left > 1 ? t + (t_limit - t) / left : t_limit;
    if (!(t_new > t)) return {StepResult::Outcome::step_underflow, -1};
    const double h = t_new - t;
    // Where the slope at the start is not known, the first stage stays there.
    base_ = state_.y;
    combine(known_ ? gamma * h : 0, slope_, 0, first_, stage_);
    if (const StepResult r = evaluate(t + gamma * h, gamma * h, first_); r.outcome != StepResult::Outcome::ok) return r;
    combine(known_ ? h - ahead * h : 0, slope_, ahead * h, first_, stage_);
    combine(0, slope_, (1 - gamma) * h, first_, base_);
    // What jumps at the end belongs to the step after.
    if (const StepResult r = evaluate(just_before(t_new, t), gamma * h, slope_); r.outcome != StepResult::Outcome::ok)
      return r;
    before_ = state_;
    for (std::size_t i = 0; i < base_.size(); ++i) state_.y[i] = base_[i] + gamma * h * slope_[i];
    state_.time = t_new;
    equations_.normalize(state_.y);
    known_ = true;
    ++statistics_.accepted;
    statistics_.largest_step = std::max(statistics_.largest_step, h);
    statistics_.smallest_step = statistics_.accepted == 1 ? h : std::min(statistics_.smallest_step, h);
    return {};
  }
  const State& state() const override { return state_; }
  /// On the straight line between the ends.
  void interpolate(double t, std::span<double> y) const override {
    const double h = state_.time - before_.time;
    const double theta = h > 0 ? std::clamp((t - before_.time) / h, 0.0, 1.0) : 1;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (1 - theta) * before_.y[i] + theta * state_.y[i];
    keep_discrete_states(equations_.layout(), state_.y, y);
    equations_.normalize(y);
  }
  void restart() override { known_ = false; }
  void jump(const State& state) override {
    state_ = before_ = state;
    known_ = false;
  }
  std::vector<double> memory() const override { return {}; }
  void resume(const State& state, std::span<const double> /*memory*/) override { jump(state); }
  const StepStatistics& statistics() const override { return statistics_; }

 private:
  static constexpr double gamma = 1 - 0.70710678118654752;
  /// Weight of k₁ in Y₂, by which slopes that are linear in time are followed exactly; without a slope at the start, by
  /// which the method is of order 2.
  static constexpr double ahead = 1 / (2 * gamma);

  /// Sets result = y + a k + b l.
  void combine(double a, const std::vector<double>& k, double b, const std::vector<double>& l,
               std::vector<double>& result) const {
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = state_.y[i] + a * k[i] + b * l[i];
  }
  /// The slope at stage_, with stiffness and damping where it leads from base_.
  StepResult evaluate(double t, double delta, std::vector<double>& slope) {
    ++statistics_.evaluations;
    const Evaluation e = linear_.implicit_derivatives(t, stage_, base_, delta, slope, work_);
    if (e.outcome == Evaluation::Outcome::singular) return {StepResult::Outcome::singular, e.body};
    double sum = 0;
    for (const double k : slope) sum += k * 0.0;
    if (!e.ok() || sum != 0) return {StepResult::Outcome::nonfinite, e.body};
    return {};
  }

  const EquationsOfMotion& equations_;
  const LinearlyImplicit& linear_;
  Work work_;
  double step_;
  std::vector<double> ends_;
  State state_, before_;
  std::vector<double> stage_, base_, first_, slope_;  ///< slope_: k₂ of the last step
  bool known_ = false;                                ///< slope_ is that at the state
  StepStatistics statistics_;
};

}  // namespace

CoarseSteps::CoarseSteps(std::vector<double> ends)
    : step_(std::numeric_limits<double>::infinity()), ends_(std::move(ends)) {}

std::unique_ptr<Stepper> CoarseSteps::start(const EquationsOfMotion& equations, const State& state) const {
  const LinearlyImplicit* linear = equations.linearly_implicit();
  if (linear == nullptr) throw std::invalid_argument("coarse steps are for linearly implicit equations");
  return std::make_unique<SemiImplicitStepper>(equations, *linear, state, step_, ends_);
}

}  // namespace withy
