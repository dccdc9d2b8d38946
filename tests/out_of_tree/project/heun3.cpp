// An integrator: Heun's method of order 3 with equal steps h,
//   k₁ = f(t, y), k₂ = f(t + h/3, y + h/3 k₁), k₃ = f(t + 2h/3, y + 2h/3 k₂), y⁺ = y + h/4 (k₁ + 3 k₃),
// and within a step the cubic through the values and slopes at its ends.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <withy/core/plugin/closed_loops.hpp>
#include <withy/core/plugin/discrete_states.hpp>
#include <withy/core/plugin/integrator.hpp>
#include <withy/core/plugin/just_before.hpp>
#include <withy/core/plugin/memory.hpp>

#include "laws.hpp"

namespace example {
namespace {
using Array = Eigen::ArrayXd;
using Outcome = withy::StepResult::Outcome;

class Heun3Stepper final : public withy::Stepper {
 public:
  Heun3Stepper(const withy::EquationsOfMotion& equations, const withy::State& start, double step)
      : equations_(equations), work_(equations.make_work()), longest_(step) {
    if (dynamic_cast<const withy::ClosedLoops*>(&equations) != nullptr)
      withy::refuse_loops("heun3", "it does not close them at the ends of its steps");
    for (Array* a : {&slope_, &previous_slope_, &stage_, &k2_, &k3_, &next_slope_}) a->setZero(size());
    jump(start);
    equations_.normalize(state_.y);
  }
  withy::StepResult step(double t_limit) override {
    const double t = state_.time;
    if (!(t_limit > t)) return {};
    // What is left to the limit is divided equally; the allowance keeps rounding from adding a step.
    const double steps = std::ceil((t_limit - t) / longest_ * (1 - 1e-9));
    const double end = steps > 1 ? t + (t_limit - t) / steps : t_limit, h = end - t;
    if (!(h > 0)) return {Outcome::step_underflow};
    latest_ = withy::just_before(t_limit, t);  // what jumps at the limit belongs to the steps after it
    if ((slope_known_ || evaluate(t, stage_ = y(), slope_)) &&
        evaluate(t + h / 3, stage_ = y() + h / 3 * slope_, k2_) &&
        evaluate(t + 2 * h / 3, stage_ = y() + 2 * h / 3 * k2_, k3_) &&
        evaluate(end, normalized(stage_ = y() + h / 4 * (slope_ + 3 * k3_)), next_slope_)) {
      accept(end, h);
      return {};
    }
    ++statistics_.rejected;
    return {last_.outcome == withy::Evaluation::Outcome::singular ? Outcome::singular : Outcome::nonfinite, last_.body};
  }
  void interpolate(double t, std::span<double> out) const override {
    Eigen::Map<Array> values(out.data(), size());
    const Eigen::Map<const Array> before(previous_.y.data(), size());
    const double h = state_.time - previous_.time;
    const double a = h > 0 ? std::clamp((t - previous_.time) / h, 0.0, 1.0) : 1, b = 1 - a;
    values = b * b * ((1 + 2 * a) * before + h * a * previous_slope_) + a * a * ((1 + 2 * b) * y() - h * b * slope_);
    withy::keep_discrete_states(equations_.layout(), state_.y, out);
    if (a > 0 && a < 1) equations_.normalize(out);
  }
  const withy::State& state() const override { return state_; }
  const withy::StepStatistics& statistics() const override { return statistics_; }
  void restart() override { slope_known_ = false; }
  void jump(const withy::State& state) override {
    if (state.y.size() != equations_.size()) throw std::invalid_argument("the state is one of other equations");
    state_ = previous_ = state;
    restart();
  }
  std::vector<double> memory() const override {
    withy::Memory memory;
    const_cast<Heun3Stepper*>(this)->remember(memory);  // which only reads them, since it writes
    return memory.numbers();
  }
  void resume(const withy::State& state, std::span<const double> numbers) override {
    jump(state);
    withy::Memory memory(numbers);
    remember(memory);
    memory.finish();
    if (slope_.size() != size()) throw std::invalid_argument("the memory is that of a stepper of other equations");
  }

 private:
  Eigen::Map<const Array> y() const { return {state_.y.data(), size()}; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(equations_.size()); }
  const Array& normalized(Array& values) const {
    equations_.normalize({values.data(), equations_.size()});
    return values;
  }
  /// Whether the slope there could be had.
  bool evaluate(double t, const Array& values, Array& slope) {
    ++statistics_.evaluations;
    last_ = equations_.derivatives(std::min(t, latest_), {values.data(), equations_.size()},
                                   {slope.data(), equations_.size()}, work_);
    return last_.ok() && slope.isFinite().all();
  }
  void accept(double end, double h) {
    withy::StepStatistics& s = statistics_;
    s.smallest_step = s.accepted == 0 ? h : std::min(s.smallest_step, h);
    s.largest_step = std::max(s.largest_step, h);
    s.determinant_sign = last_.determinant_sign;
    ++s.accepted;
    std::swap(previous_, state_);
    state_.time = end;
    std::copy(stage_.begin(), stage_.end(), state_.y.begin());
    previous_slope_.swap(slope_);
    slope_.swap(next_slope_);
    slope_known_ = true;
  }
  /// All that the next steps depend on beyond the state.
  void remember(withy::Memory& memory) {
    withy::StepStatistics& s = statistics_;
    const auto all = [&](auto&... member) { (memory(member), ...); };
    all(s.accepted, s.rejected, s.evaluations, s.smallest_step, s.largest_step, s.determinant_sign, slope_known_,
        slope_);
  }

  const withy::EquationsOfMotion& equations_;
  withy::Work work_;
  double longest_;                 ///< step [s]
  double latest_ = 0;              ///< last time at which this step may evaluate
  withy::State state_, previous_;  ///< at both ends of the last step
  Array slope_, previous_slope_, stage_, k2_, k3_, next_slope_;
  withy::Evaluation last_;
  withy::StepStatistics statistics_;
  bool slope_known_ = false;
};

class Heun3 final : public withy::Integrator {
 public:
  explicit Heun3(double step) : step_(step) {}
  std::unique_ptr<withy::Stepper> start(const withy::EquationsOfMotion& equations,
                                        const withy::State& state) const override {
    return std::make_unique<Heun3Stepper>(equations, state, step_);
  }
  int order() const override { return 3; }
  /// The growth of an oscillation in a step is |R(iz)|² = 1 − z⁴/12 + z⁶/36, z = hω; 1.01² at this z.
  std::optional<double> stability_limit() const override { return 1.7539; }

 private:
  double step_;
};

}  // namespace

withy::Plugin<withy::Integrator> heun3() {
  return {.id = "heun3",
          .summary = "Heun's method of order 3, equal steps",
          .parameters = {withy::number("step", "s", "greatest step; intervals are divided equally").above(0)},
          .make = [](const withy::Value& p, const withy::MakeContext&) -> std::unique_ptr<withy::Integrator> {
            return std::make_unique<Heun3>(p.number_at("step"));
          }};
}

}  // namespace example
