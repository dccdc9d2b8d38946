/// \file
/// Methods whose step the user gives.
#pragma once

#include "one_step.hpp"
#include "withy/core/plugin/given_steps.hpp"
#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// Divides every interval between two landings into equal steps, none longer than `step` [s].
class EqualSteps : public OneStep, public GivenSteps {
 public:
  EqualSteps(const EquationsOfMotion& equations, const State& start, double step)
      : OneStep(equations, start), step_(step) {}

  StepResult step(double t_limit) final {
    const double t = state_.time;
    if (!(t_limit > t)) return {};
    if (const StepResult r = begin(t_limit); r.outcome != StepResult::Outcome::ok) return r;
    if (next_end_ == ends_.count || ends_.from != t || ends_.limit != t_limit) look_ahead(t, t_limit);
    double t_new = ends_.at[next_end_];
    if (!(t_new > t)) return {StepResult::Outcome::step_underflow, -1};
    for (int halvings = 0;; ++halvings) {
      solved_ = true;
      const Evaluation evaluation = attempt(t_new - t);
      if (evaluation.ok() && solved_ && finite(next_, next_slope_)) break;
      ++statistics_.rejected;
      if (evaluation.ok() && !solved_) ++unsolved_;
      const double half = t + (t_new - t) / 2;
      if (halvings == most_halvings() || !(half > t && half < t_new)) {
        if (evaluation.ok() && !solved_) return {StepResult::Outcome::step_underflow, -1};
        return failure(evaluation);
      }
      t_new = half;
    }
    const double h = t_new - t;
    ends_.from = t_new;
    next_end_ = t_new == ends_.at[next_end_] ? next_end_ + 1 : ends_.count;
    accept(t_new);
    accepted(h);
    return {};
  }

 protected:
  /// Tries a step h from state_ with slope_: fills next_ (normalized) and next_slope_.
  virtual Evaluation attempt(double h) = 0;
  /// What an implicit method's attempt gives where it has not solved the equations of the step.
  Evaluation unsolved(const Evaluation& last) {
    solved_ = false;
    return last;
  }
  /// Called after state_, slope_ and their predecessors are those of an accepted step h.
  virtual void accepted(double /*h*/) {}
  /// The slope at the end of a step during which nothing moves; zero where it cannot be had.
  const Eigen::ArrayXd& slope_ahead(double h) {
    next_ = y();
    if (!evaluate(state_.time + h, next_, next_slope_).ok() || !finite(next_slope_)) next_slope_.setZero();
    return next_slope_;
  }
  /// The ends of the step that `attempt` is to try and of those after it; empty where it is a part of a step.
  [[nodiscard]] std::span<const double> ends_of(double h) const {
    if (h != ends_.at[next_end_] - state_.time) return {};
    return std::span(ends_.at).first(ends_.count).subspan(next_end_);
  }
  void remember(Memory& memory) override {
    OneStep::remember(memory);
    memory(unsolved_);
  }
  /// What an implicit method says of its Jacobian, and of its steps.
  [[nodiscard]] std::vector<std::string> with_unsolved(std::vector<std::string> remarks) const {
    if (unsolved_ > 0)
      remarks.push_back(std::to_string(unsolved_) + (unsolved_ > 1 ? " steps were" : " step was") +
                        " halved where the iteration did not converge, as where something is far too fast for the "
                        "step: then its vibration is one of the steps and not its own");
    return remarks;
  }
  /// How often a step that fails is halved.
  [[nodiscard]] virtual int most_halvings() const { return 0; }

 private:
  /// What remains is divided equally, so that the last step is no shorter than the others; the allowance keeps the
  /// rounding of earlier steps from adding one.
  [[nodiscard]] double end_of_step(double t, double t_limit) const {
    const double steps = std::ceil((t_limit - t) / step_ * (1 - 1e-9));
    return steps > 1 ? t + (t_limit - t) / steps : t_limit;
  }
  /// The ends of the steps that follow each other from a time on.
  struct Ends {
    double from = 0, limit = 0, step = 0;  ///< what they were found for [s]
    std::size_t count = 0;
    std::array<double, 8> at{};  ///< [s]
  };
  /// Finds the ends of the next steps, of one where nobody makes several.
  void look_ahead(double t, double t_limit) {
    next_end_ = 0;
    if (!staged()) {
      ends_.from = t, ends_.limit = t_limit, ends_.count = 1;
      ends_.at[0] = end_of_step(t, t_limit);
      return;
    }
    // Cases in lanes mostly go through the same times.
    thread_local Ends last;
    if (last.count == 0 || last.from != t || last.limit != t_limit || last.step != step_) {
      last = {t, t_limit, step_, 0, {}};
      double end = t;
      do {
        end = last.at[last.count++] = end_of_step(end, t_limit);
      } while (last.count < last.at.size() && end < t_limit);
    }
    ends_ = last;
  }

  double step_;
  bool solved_ = true;        ///< the equations of the implicit step being tried
  Ends ends_;                 ///< of the next steps to the limit where each is accepted; `from` goes with the steps
  std::size_t next_end_ = 0;  ///< in ends_
  std::size_t unsolved_ = 0;  ///< attempts whose equations were not solved
};

inline ParameterSpec step_parameter() {
  return number("step", "s", "greatest step; intervals are divided equally").above(0);
}

/// Running sizes of all positions and speeds, to which the iterations of implicit steps are relative: the greatest
/// |y| and |h ẏ| since the start, and for what is hardly more than rounding a part of the greatest of all.
class Sizes {
 public:
  explicit Sizes(Eigen::Index size) : sizes_(Eigen::ArrayXd::Zero(size)) {}
  /// `ahead()` is the slope a step ahead of rest: asked for where all else is zero, until a load begins.
  template <class Values, class Ahead>
  const Eigen::ArrayXd& update(const Values& y, double h, const Eigen::ArrayXd& slope, Ahead&& ahead) {
    sizes_ = sizes_.max(y.abs()).max(std::abs(h) * slope.abs());
    if (sizes_.head(sizes_.size() - 1).maxCoeff() == 0) sizes_ = std::abs(h) * ahead().abs();
    const double greatest = sizes_.head(sizes_.size() - 1).maxCoeff();
    sizes_ = sizes_.max(1e-6 * greatest + std::numeric_limits<double>::min());
    return sizes_;
  }
  void forget() { sizes_.setZero(); }
  void remember(Memory& memory) { memory(sizes_); }

 private:
  Eigen::ArrayXd sizes_;
};

}  // namespace withy
