/// \file
/// The linearly implicit W-method ROS34PW2 of Rang & Angermann (BIT 45, 2005, 761–787): four stages, order 3, embedded
/// order 2, L-stable, stiffly accurate. A W-method keeps its order with any matrix in the place of the Jacobian; here
/// it is that of modal stiffness and damping alone (LinearlyImplicit), which costs one recursion to factorize.
///   (1 − hγA) k_i = h f(t + α_i h, y + Σ α_ij k_j) + h A Σ γ_ij k_j,   y_new = y + Σ b_i k_i;
/// with g = Σ_{j<i} γ_ij k_j / γ the right-hand side needs no product with A: (1 − hγA)(k_i + g) = h f + g.
#include <array>

#include "adaptive_stepper.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace rosenbrock_w {

constexpr double gamma_ii = 0.435866521508459;
constexpr double a21 = 0.87173304301691801, a31 = 0.84457060015369423, a32 = -0.11299064236484185, a43 = 1;
constexpr double g21 = -0.87173304301691801, g31 = -0.90338057013044082, g32 = 0.054180672388095326;
constexpr double g41 = 0.24212380706095346, g42 = -1.2232505839045147, g43 = 0.54526025533510214;
constexpr std::array<double, 4> b = {0.24212380706095346, -1.2232505839045147, 1.545260255335102, 0.435866521508459};
constexpr std::array<double, 4> b_low = {0.37810903145819369, -0.096042292212423178, 0.5, 0.2179332607542295};

class RosenbrockWStepper final : public AdaptiveStepper {
 public:
  static constexpr int order = 3;
  static constexpr double stability_limit = std::numeric_limits<double>::infinity();

  RosenbrockWStepper(const EquationsOfMotion& equations, const State& start, const StepControl& control)
      : AdaptiveStepper(equations, start, control, 3, 9),
        linear_(solver_of(equations, "rosenbrock-w")),
        factors_(linear_.make_factors()) {
    for (Eigen::ArrayXd* a : {&stage_, &slope_here_, &shift_, &k1_, &k2_, &k3_, &k4_}) a->setZero(size());
  }

 private:
  Trial attempt(double h) override {
    const double t = state_.time;
    if (const Evaluation e = linear_.factorize(state_.y, h * gamma_ii, factors_); !e.ok()) return {e};
    k1_ = h * slope_;
    solve(k1_);
    shift_ = g21 / gamma_ii * k1_;
    if (const Evaluation e = stage(t + a21 * h, y() + a21 * k1_, h, k2_); !e.ok()) return {e};
    shift_ = (g31 * k1_ + g32 * k2_) / gamma_ii;
    if (const Evaluation e = stage(t + (a31 + a32) * h, y() + a31 * k1_ + a32 * k2_, h, k3_); !e.ok()) return {e};
    shift_ = (g41 * k1_ + g42 * k2_ + g43 * k3_) / gamma_ii;
    if (const Evaluation e = stage(t + a43 * h, y() + a43 * k3_, h, k4_); !e.ok()) return {e};
    next_ = y() + b[0] * k1_ + b[1] * k2_ + b[2] * k3_ + b[3] * k4_;
    normalize(next_);
    error_ = (b[0] - b_low[0]) * k1_ + (b[1] - b_low[1]) * k2_ + (b[2] - b_low[2]) * k3_ + (b[3] - b_low[3]) * k4_;
    Trial trial{{}, error_ratio()};
    if (!(trial.error > 1)) trial.evaluation = evaluate(t + h, next_, next_slope_);
    return trial;
  }

  /// k of the stage at these values, for the `shift_` of the stages before.
  template <class Expression>
  Evaluation stage(double t, const Expression& values, double h, Eigen::ArrayXd& k) {
    stage_ = values;
    const Evaluation e = evaluate(t, stage_, slope_here_);
    if (!e.ok()) return e;
    k = h * slope_here_ + shift_;
    solve(k);
    k -= shift_;
    return e;
  }
  void solve(Eigen::ArrayXd& r) { linear_.solve({r.data(), static_cast<std::size_t>(r.size())}, factors_); }

  void accepted(double /*h*/) override {}

  void inside(double theta, Values values) const override { cubic(theta, values); }

  const LinearlyImplicit& linear_;
  Work factors_;
  Eigen::ArrayXd stage_, slope_here_, shift_, k1_, k2_, k3_, k4_;
};

}  // namespace rosenbrock_w

void enroll_rosenbrock_w(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "rosenbrock-w",
       .summary = "Linearly implicit method of order 3, L-stable: steps are not limited by the modes' frequencies",
       .parameters = step_control_parameters(),
       .make = &make_controlled<rosenbrock_w::RosenbrockWStepper>});
}

}  // namespace withy
