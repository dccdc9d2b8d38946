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
    const Eigen::ArrayXd& k1 = slope_;
    const Eigen::ArrayXd& k7 = next_slope_;
    if (const Evaluation e = staged() ? whole(h) : one_by_one(h); !e.ok()) return {e};
    error_ = h * (71.0 / 57600 * k1 - 71.0 / 16695 * k3_ + 71.0 / 1920 * k4_ - 17253.0 / 339200 * k5_ +
                  22.0 / 525 * k6_ - 1.0 / 40 * k7);
    return {{}, error_ratio()};
  }

  Evaluation one_by_one(double h) {
    const double t = state_.time;
    const Eigen::ArrayXd& k1 = slope_;
    stage_ = y() + h / 5 * k1;
    if (const Evaluation e = evaluate(t + h / 5, stage_, k2_); !e.ok()) return e;
    stage_ = y() + h * (3.0 / 40 * k1 + 9.0 / 40 * k2_);
    if (const Evaluation e = evaluate(t + 3 * h / 10, stage_, k3_); !e.ok()) return e;
    stage_ = y() + h * (44.0 / 45 * k1 - 56.0 / 15 * k2_ + 32.0 / 9 * k3_);
    if (const Evaluation e = evaluate(t + 4 * h / 5, stage_, k4_); !e.ok()) return e;
    stage_ = y() + h * (19372.0 / 6561 * k1 - 25360.0 / 2187 * k2_ + 64448.0 / 6561 * k3_ - 212.0 / 729 * k4_);
    if (const Evaluation e = evaluate(t + 8 * h / 9, stage_, k5_); !e.ok()) return e;
    stage_ = y() + h * (9017.0 / 3168 * k1 - 355.0 / 33 * k2_ + 46732.0 / 5247 * k3_ + 49.0 / 176 * k4_ -
                        5103.0 / 18656 * k5_);
    if (const Evaluation e = evaluate(t + h, stage_, k6_); !e.ok()) return e;
    next_ =
        y() + h * (35.0 / 384 * k1 + 500.0 / 1113 * k3_ + 125.0 / 192 * k4_ - 2187.0 / 6784 * k5_ + 11.0 / 84 * k6_);
    // Normalized before the last stage, which is the first of the next step.
    normalize(next_);
    return evaluate(t + h, next_, next_slope_);
  }
  Evaluation whole(double h) {
    const auto taken = [](Eigen::ArrayXd& k) { return std::span(k.data(), static_cast<std::size_t>(k.size())); };
    return whole_step(whole_dopri5, h, std::array{taken(k2_), taken(k3_), taken(k4_), taken(k5_), taken(k6_)});
  }

  void accepted(double h) override {
    const Eigen::ArrayXd& k1 = previous_slope_;
    const Eigen::ArrayXd& k7 = slope_;
    c2_ = y() - previous_;
    c3_ = h * k1 - c2_;
    c4_ = c2_ - h * k7 - c3_;
    c5_ = h * (-12715105075.0 / 11282082432.0 * k1 + 87487479700.0 / 32700410799.0 * k3_ -
               10690763975.0 / 1880347072.0 * k4_ + 701980252875.0 / 199316789632.0 * k5_ -
               1453857185.0 / 822651844.0 * k6_ + 69997945.0 / 29380423.0 * k7);
  }

  void inside(double theta, Values values) const override {
    const double u = 1 - theta;
    values = previous_ + theta * (c2_ + u * (c3_ + theta * (c4_ + u * c5_)));
  }

  Eigen::ArrayXd stage_, k2_, k3_, k4_, k5_, k6_;
  Eigen::ArrayXd c2_, c3_, c4_, c5_;  ///< the continuous extension over the last accepted step
};

}  // namespace

void enroll_dopri5(Enrollment& enrollment) {
  enrollment.add<Integrator>({.id = "dopri5",
                              .summary = "Dormand-Prince pair of orders 5 and 4 with dense output",
                              .parameters = step_control_parameters(),
                              .make = &make_controlled<Dopri5Stepper>});
}

}  // namespace withy
