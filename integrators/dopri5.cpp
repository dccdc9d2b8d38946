/// \file
/// The pair 5(4) of Dormand & Prince (J. Comput. Appl. Math. 6, 1980, 19–26) with the continuous extension of order 4
/// in Hairer, Nørsett & Wanner I, II.6. Six evaluations a step.
#include "adaptive_stepper.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// The pair's stages, for equations that make whole steps.
constexpr StageTable whole_dopri5 = [] {
  StageTable table;
  table.stages = 7;
  table.c = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
  table.a[1] = {1.0 / 5};
  table.a[2] = {3.0 / 40, 9.0 / 40};
  table.a[3] = {44.0 / 45, -56.0 / 15, 32.0 / 9};
  table.a[4] = {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729};
  table.a[5] = {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656};
  table.a[6] = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84};
  return table;
}();

/// Whether the processor adds four numbers at once.
#if defined(__x86_64__)
const bool wide = __builtin_cpu_supports("avx2") != 0;
#else
constexpr bool wide = false;
#endif

class Dopri5Stepper final : public AdaptiveStepper {
 public:
  static constexpr int order = 5;
  static constexpr double stability_limit = 1.725;

  Dopri5Stepper(const EquationsOfMotion& equations, const State& start, const StepControl& control)
      : AdaptiveStepper(equations, start, control, 5, 3) {
    for (Eigen::ArrayXd* a : {&stage_, &k2_, &k3_, &k4_, &k5_, &k6_, &c2_, &c3_, &c4_, &c5_}) a->setZero(size());
  }

 private:
  Trial attempt(double h) override {
    stages_ = Stages::of_an_attempt;
    return wide ? attempt_by_fours(h) : attempt_by_any(h);
  }
#if defined(__x86_64__)
  // The same numbers: without FMA sums are rounded as ever.
  [[gnu::target("avx2")]] Trial attempt_by_fours(double h) { return attempt_by_any(h); }
#else
  Trial attempt_by_fours(double h) { return attempt_by_any(h); }
#endif

  [[gnu::always_inline]] Trial attempt_by_any(double h) {
    if (const Evaluation e = staged() ? whole(h) : one_by_one(h); !e.ok()) return {e};
    const double *const k1 = slope_.data(), *const k3 = k3_.data(), *const k4 = k4_.data(), *const k5 = k5_.data(),
                        *const k6 = k6_.data(), *const k7 = next_slope_.data();
    set(error_, [=](Eigen::Index i) {
      return h * (71.0 / 57600 * k1[i] - 71.0 / 16695 * k3[i] + 71.0 / 1920 * k4[i] - 17253.0 / 339200 * k5[i] +
                  22.0 / 525 * k6[i] - 1.0 / 40 * k7[i]);
    });
    return {{}, error_ratio()};
  }

  [[gnu::always_inline]] Evaluation one_by_one(double h) {
    const double t = state_.time;
    const double *const y0 = state_.y.data(), *const k1 = slope_.data(), *const k2 = k2_.data(), *const k3 = k3_.data(),
                        *const k4 = k4_.data(), *const k5 = k5_.data(), *const k6 = k6_.data();
    set(stage_, [=](Eigen::Index i) { return y0[i] + h / 5 * k1[i]; });
    if (const Evaluation e = evaluate(t + h / 5, stage_, k2_); !e.ok()) return e;
    set(stage_, [=](Eigen::Index i) { return y0[i] + h * (3.0 / 40 * k1[i] + 9.0 / 40 * k2[i]); });
    if (const Evaluation e = evaluate(t + 3 * h / 10, stage_, k3_); !e.ok()) return e;
    set(stage_, [=](Eigen::Index i) { return y0[i] + h * (44.0 / 45 * k1[i] - 56.0 / 15 * k2[i] + 32.0 / 9 * k3[i]); });
    if (const Evaluation e = evaluate(t + 4 * h / 5, stage_, k4_); !e.ok()) return e;
    set(stage_, [=](Eigen::Index i) {
      return y0[i] +
             h * (19372.0 / 6561 * k1[i] - 25360.0 / 2187 * k2[i] + 64448.0 / 6561 * k3[i] - 212.0 / 729 * k4[i]);
    });
    if (const Evaluation e = evaluate(t + 8 * h / 9, stage_, k5_); !e.ok()) return e;
    set(stage_, [=](Eigen::Index i) {
      return y0[i] + h * (9017.0 / 3168 * k1[i] - 355.0 / 33 * k2[i] + 46732.0 / 5247 * k3[i] + 49.0 / 176 * k4[i] -
                          5103.0 / 18656 * k5[i]);
    });
    if (const Evaluation e = evaluate(t + h, stage_, k6_); !e.ok()) return e;
    set(next_, [=](Eigen::Index i) {
      return y0[i] + h * (35.0 / 384 * k1[i] + 500.0 / 1113 * k3[i] + 125.0 / 192 * k4[i] - 2187.0 / 6784 * k5[i] +
                          11.0 / 84 * k6[i]);
    });
    // Normalized before the last stage, which is the first of the next step.
    normalize(next_);
    return evaluate(t + h, next_, next_slope_);
  }
  /// All numbers of an array that none of those that `number` reads are in: in a loop without tests of that.
  template <class Number>
  [[gnu::always_inline]] static void set(Eigen::ArrayXd& to, const Number& number) {
    double* const out = to.data();
    const Eigen::Index size = to.size();
#if !defined(__clang__)  // which does not know it
#pragma GCC ivdep
#endif
    for (Eigen::Index i = 0; i < size; ++i) out[i] = number(i);
  }
  Evaluation whole(double h) {
    const auto taken = [](Eigen::ArrayXd& k) { return std::span(k.data(), static_cast<std::size_t>(k.size())); };
    return whole_step(whole_dopri5, h, std::array{taken(k2_), taken(k3_), taken(k4_), taken(k5_), taken(k6_)});
  }

  void accepted(double /*h*/) override { stages_ = Stages::of_last_step; }

  void inside(double theta, Values values) const override {
    if (stages_ == Stages::of_last_step) extend();
    if (stages_ == Stages::of_an_attempt) return cubic(theta, values);  // which has come to nothing
    const double u = 1 - theta;
    values = previous_ + theta * (c2_ + u * (c3_ + theta * (c4_ + u * c5_)));
  }

  /// Finds the continuous extension over the last accepted step: few steps are looked into.
  void extend() const {
    const double h = state_.time - previous_time_;
    const Eigen::ArrayXd& k1 = previous_slope_;
    const Eigen::ArrayXd& k7 = slope_;
    c2_ = y() - previous_;
    c3_ = h * k1 - c2_;
    c4_ = c2_ - h * k7 - c3_;
    c5_ = h * (-12715105075.0 / 11282082432.0 * k1 + 87487479700.0 / 32700410799.0 * k3_ -
               10690763975.0 / 1880347072.0 * k4_ + 701980252875.0 / 199316789632.0 * k5_ -
               1453857185.0 / 822651844.0 * k6_ + 69997945.0 / 29380423.0 * k7);
    stages_ = Stages::extended;
  }

  /// What k2_ to k6_ are stages of; `extended`: of the last accepted step, and its extension is known.
  enum class Stages { of_an_attempt, of_last_step, extended };
  mutable Stages stages_ = Stages::of_an_attempt;
  Eigen::ArrayXd stage_, k2_, k3_, k4_, k5_, k6_;
  mutable Eigen::ArrayXd c2_, c3_, c4_, c5_;  ///< the continuous extension over the last accepted step
};

}  // namespace

void enroll_dopri5(Enrollment& enrollment) {
  enrollment.add<Integrator>({.id = "dopri5",
                              .summary = "Dormand-Prince pair of orders 5 and 4 with dense output",
                              .parameters = step_control_parameters(),
                              .make = &make_controlled<Dopri5Stepper>});
}

}  // namespace withy
