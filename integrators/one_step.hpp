/// \file
/// What one-step methods share: the state and its slope at both ends of the last accepted step, evaluations, landing.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/discrete_states.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/just_before.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/plugin/staged_steps.hpp"

namespace withy {

/// A stepper that knows y and ẏ at both ends of its last step. Everything is allocated by the constructor.
///
/// A jump of the right-hand side at t_limit belongs to the steps after it: no stage of a step is evaluated later than
/// at the last double below t_limit, so a step that lands there sees only the values before the jump. `restart` makes
/// the next step evaluate at t_limit itself.
class OneStep : public Stepper, public ClosingStepper {
 public:
  OneStep(const EquationsOfMotion& equations, const State& start)
      : state_(start),
        previous_time_(start.time),
        equations_(equations),
        loops_(dynamic_cast<const ClosedLoops*>(&equations)),
        staged_(dynamic_cast<const StagedSteps*>(&equations)),
        work_(equations.make_work()),
        closing_work_(loops_ != nullptr ? equations.make_work() : Work(0)),
        size_(static_cast<Eigen::Index>(equations.size())) {
    check_size(start);
    if (loops_ != nullptr) {
      energy_ = equations.make_observation();
      opened_ = change_ = smallest_ = Eigen::ArrayXd::Zero(size_);
      loops_->close(state_.y, closing_work_);
    } else {
      equations_.normalize(state_.y);
    }
    previous_ = y();
    for (Eigen::ArrayXd* a : {&slope_, &previous_slope_, &next_, &next_slope_}) a->setZero(size_);
  }

  [[nodiscard]] const State& state() const final { return state_; }
  [[nodiscard]] const StepStatistics& statistics() const final { return statistics_; }
  [[nodiscard]] Work* evaluated() const final { return last_ == Last::at_state ? &work_ : nullptr; }
  void restart() override { slope_known_ = false; }
  void jump(const State& state) final {
    place(state);
    restart();
  }
  [[nodiscard]] std::vector<double> memory() const final {
    Memory memory;
    const_cast<OneStep*>(this)->remember(memory);  // which only reads them, since it writes
    return memory.numbers();
  }
  void resume(const State& state, std::span<const double> numbers) final {
    place(state);
    Memory memory(numbers);
    remember(memory);
    memory.finish();
    if (slope_.size() != size_) throw std::invalid_argument("the memory is that of a stepper of other equations");
  }

  /// At and outside the ends of the last step: the state at that end, bit by bit. Inside: the method's interpolant with
  /// its quaternions normalized, and the step's discrete states.
  void interpolate(double t, std::span<double> out) const final {
    Eigen::Map<Eigen::ArrayXd> values(out.data(), size_);
    if (t >= state_.time) {
      values = y();
    } else if (t <= previous_time_) {
      values = previous_;
    } else {
      inside((t - previous_time_) / (state_.time - previous_time_), values);
      keep_discrete_states(equations_.layout(), state_.y, out);
      if (loops_ == nullptr) {
        equations_.normalize(out);
      } else {
        close(values);
      }
    }
  }
  [[nodiscard]] const ClosingRecord& closing_record() const final { return closed_; }

 protected:
  using Values = Eigen::Map<Eigen::ArrayXd>;

  /// Names all that the next steps depend on beyond the state.
  virtual void remember(Memory& memory) {
    memory(statistics_.accepted);
    memory(statistics_.rejected);
    memory(statistics_.evaluations);
    memory(statistics_.smallest_step);
    memory(statistics_.largest_step);
    memory(statistics_.determinant_sign);
    memory(sign_);
    memory(slope_known_);
    memory(slope_);
    if (loops_ == nullptr) return;
    memory(closed_.gap);
    memory(closed_.energy);
    memory(apart_);
  }

  /// Of the changes to y that close its loops, the smallest in the sense of M, those that close them as well, but for
  /// their square, and stress less, in place. \returns whether there are any.
  virtual bool soften(Eigen::ArrayXd& /*change*/) const { return false; }

  /// The interpolant at fraction theta in (0, 1) of the last accepted step.
  virtual void inside(double theta, Values values) const = 0;

  /// The cubic through values and slopes of both ends: error O(h⁴).
  void cubic(double theta, Values values) const {
    const double h = state_.time - previous_time_;
    const double u = 1 - theta;
    values = u * u * ((1 + 2 * theta) * previous_ + h * theta * previous_slope_) +
             theta * theta * ((1 + 2 * u) * y() - h * u * slope_);
  }

  /// To be called first in a step: sets the limit of stage times and finds the slope at the start where it is unknown.
  StepResult begin(double t_limit) {
    if (apart_) return {StepResult::Outcome::singular};
    if (t_limit != limit_) latest_ = just_before(limit_ = t_limit, state_.time);
    if (slope_known_) return {};
    const Evaluation e = evaluate(state_.time, next_ = y(), slope_);
    if (!e.ok() || !finite(slope_)) return failure(e);
    slope_known_ = true;
    return {};
  }

  /// Const, so that interpolants may evaluate too: only memory for the work and counters change.
  Evaluation evaluate(double t, const Eigen::ArrayXd& values, Eigen::ArrayXd& slope) const {
    ++statistics_.evaluations;
    last_ = Last::elsewhere;
    follows_ = whole_ = false;
    if (std::exchange(open_, false)) return {Evaluation::Outcome::singular};
    const auto n = static_cast<std::size_t>(size_);
    const Evaluation e = equations_.derivatives(std::min(t, latest_), {values.data(), n}, {slope.data(), n}, work_);
    sign_ = e.determinant_sign;
    return e;
  }

  /// Whether the equations make all stages of a step at once.
  [[nodiscard]] bool staged() const { return staged_ != nullptr; }
  /// Has them made for a step h from state_ with slope_: fills next_ and next_slope_. \param slopes those of the stages
  /// between the first and the last; empty: not wanted \param ends as StagedSteps::Step
  template <std::size_t count>
  Evaluation whole_step(const StageTable& table, double h, const std::array<std::span<double>, count>& slopes,
                        std::span<const double> ends = {}) {
    const auto n = static_cast<std::size_t>(size_);
    std::array<std::span<double>, count + 1> all;
    std::copy(slopes.begin(), slopes.end(), all.begin());
    all[count] = {next_slope_.data(), n};
    last_ = Last::elsewhere;
    const StagedSteps::Outcome outcome = staged_->stages({.table = &table,
                                                          .t = state_.time,
                                                          .h = h,
                                                          .latest = latest_,
                                                          .y = state_.y,
                                                          .slope = {slope_.data(), n},
                                                          .slopes = all,
                                                          .end = {next_.data(), n},
                                                          .work = &work_,
                                                          .ends = ends,
                                                          .follows = follows_});
    follows_ = false;
    whole_ = true;
    statistics_.evaluations += outcome.evaluations;
    sign_ = outcome.evaluation.determinant_sign;
    return outcome.evaluation;
  }

  /// The same with stiffness and damping implicit, see LinearlyImplicit.
  Evaluation evaluate_implicit(const LinearlyImplicit& linear, double t, const Eigen::ArrayXd& values,
                               const Eigen::ArrayXd& base, double delta, Eigen::ArrayXd& slope) const {
    ++statistics_.evaluations;
    last_ = Last::implicit;
    const auto n = static_cast<std::size_t>(size_);
    return linear.implicit_derivatives(std::min(t, latest_), {values.data(), n}, {base.data(), n}, delta,
                                       {slope.data(), n}, work_);
  }

  /// Brings the end of a step to where quaternions have unit length and loops are closed. Where they cannot be, the
  /// next evaluation fails.
  void normalize(Eigen::ArrayXd& values) {
    const std::span<double> y(values.data(), static_cast<std::size_t>(size_));
    if (loops_ == nullptr) return equations_.normalize(y);
    if (!finite(values)) return;
    equations_.normalize(y);
    const double before = energy(y);
    const Closing closing = close(values);
    open_ = !closing.closed;
    apart_next_ = closing.apart;
    closing_ = {closing.gap, energy(y) - before};
  }

  /// Makes next_ and next_slope_ the state at t_new; the last evaluation was that of next_slope_.
  void accept(double t_new) {
    const double h = t_new - state_.time;
    if (last_ == Last::elsewhere) last_ = Last::at_state;
    follows_ = std::exchange(whole_, false);
    previous_time_ = state_.time;
    previous_ = y();
    state_.time = t_new;
    Values(state_.y.data(), size_) = next_;
    previous_slope_.swap(slope_);
    slope_.swap(next_slope_);
    apart_ = apart_next_;
    closed_.gap = std::max(closed_.gap, closing_.gap);
    closed_.energy += closing_.energy;
    statistics_.smallest_step = statistics_.accepted == 0 ? h : std::min(statistics_.smallest_step, h);
    statistics_.largest_step = std::max(statistics_.largest_step, h);
    ++statistics_.accepted;
    statistics_.determinant_sign = sign_;
  }

  /// Whether all are finite; vectorizes, unlike a search for the first that is not.
  static bool finite(const Eigen::ArrayXd& values) { return (values * 0.0).sum() == 0.0; }
  static bool finite(const Eigen::ArrayXd& values, const Eigen::ArrayXd& others) {
    return (values * 0.0 + others * 0.0).sum() == 0.0;
  }

  /// What linearly implicit methods need of the equations.
  /// \throws std::invalid_argument where they have none.
  static const LinearlyImplicit& solver_of(const EquationsOfMotion& equations, const char* integrator) {
    if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr)
      refuse_loops(integrator, "its linear half knows nothing of the closing equations");
    const LinearlyImplicit* linear = equations.linearly_implicit();
    if (linear == nullptr)
      throw std::invalid_argument(std::string("integrator '") + integrator +
                                  "' folds stiffness into a symmetric mass matrix; the strict formulations have none. "
                                  "Use quadratic or ruthless, "
                                  "or another integrator: dopri5, or radau where equations are stiff");
    return *linear;
  }

  static StepResult failure(const Evaluation& e) {
    const bool singular = e.outcome == Evaluation::Outcome::singular;
    return {singular ? StepResult::Outcome::singular : StepResult::Outcome::nonfinite, e.body};
  }

  [[nodiscard]] Eigen::Map<const Eigen::ArrayXd> y() const { return {state_.y.data(), size_}; }
  [[nodiscard]] Eigen::Index size() const { return size_; }

  State state_;                    ///< last accepted
  Eigen::ArrayXd slope_;           ///< ẏ there
  double previous_time_;           ///< start of the last accepted step
  Eigen::ArrayXd previous_;        ///< y there
  Eigen::ArrayXd previous_slope_;  ///< ẏ there
  Eigen::ArrayXd next_;            ///< y at the end of the step being tried
  Eigen::ArrayXd next_slope_;      ///< ẏ there
  mutable StepStatistics statistics_;

 private:
  /// Where the last evaluation was.
  enum class Last { elsewhere, at_state, implicit };

  void check_size(const State& state) const {
    if (state.y.size() != equations_.size())
      throw std::invalid_argument("the state has " + std::to_string(state.y.size()) + " numbers, the equations need " +
                                  std::to_string(equations_.size()));
  }
  /// Takes a state as it is; the last step is one without length.
  void place(const State& state) {
    check_size(state);
    state_ = state;
    last_ = Last::elsewhere;
    follows_ = false;
    previous_time_ = state.time;
    previous_ = y();
    apart_ = false;
  }

  /// Closes the loops of a state. The smallest changes in the sense of M put gaps into what is light, as stiff modes of
  /// flexible bodies, and forces far greater than any of the motion follow: softened changes have none.
  template <class State>
  Closing close(State& state) const {
    const std::span<double> y(state.data(), static_cast<std::size_t>(size_));
    opened_ = state;
    Closing closing = loops_->close(y, closing_work_);
    change_ = state - opened_;
    if (!closing.closed || !soften(change_) || !finite(change_)) return closing;
    smallest_ = state;
    state = opened_ + change_;
    const Closing softly = loops_->close(y, closing_work_);
    if (softly.closed) {
      closing.apart = softly.apart;
    } else {
      state = smallest_;
    }
    return closing;
  }

  [[nodiscard]] double energy(std::span<const double> y) {
    energy_->observe(y);
    const Energies e = energy_->energies();
    return e.kinetic + e.potential;
  }

  const EquationsOfMotion& equations_;
  const ClosedLoops* loops_;   ///< null: the equations are a tree's
  const StagedSteps* staged_;  ///< null: stages are evaluated one by one
  mutable Work work_, closing_work_;
  std::unique_ptr<Observation> energy_;                ///< where loops are closed
  mutable Eigen::ArrayXd opened_, change_, smallest_;  ///< there: of `close`
  ClosingRecord closing_, closed_;                     ///< of the step being tried, and of all that were accepted
  mutable bool open_ = false;                          ///< the end of the step being tried cannot be closed
  bool apart_next_ = false;                            ///< it is closed as Closing::apart
  bool apart_ = false;                                 ///< so is state_, and no step follows
  Eigen::Index size_;
  double limit_ = std::numeric_limits<double>::infinity();   ///< of the step
  double latest_ = std::numeric_limits<double>::infinity();  ///< last time at which it may evaluate
  mutable int sign_ = 1;                                     ///< of det M in the last evaluation
  mutable Last last_ = Last::elsewhere;
  bool slope_known_ = false;
  mutable bool follows_ = false;  ///< state_ and slope_ are what the last whole step has given
  mutable bool whole_ = false;    ///< so are next_ and next_slope_
};

}  // namespace withy
