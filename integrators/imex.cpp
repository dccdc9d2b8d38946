/// \file
/// The semi-implicit Runge–Kutta method of order 5 after ARK5(4)8L[2]SA₂ of Kennedy & Carpenter (Appl. Numer. Math.
/// 136, 2019, 183–205). A flexible tree is ẏ = H(y, z) at z = y, where the second argument has what makes it stiff: the
/// forces of stiffness and damping, linear in z. Two arguments, two of the pair's tableaux (Boscarino, Filbet & Russo,
/// J. Sci. Comput. 68, 2016, 975–1001):
///   k_i = H(Y_i, Z_i),   Y_i = y + h Σ_{j<i} â_ij k_j,   Z_i = y + h Σ_{j≤i} a_ij k_j,   y_new = y + h Σ b_j k_j =
///   Z_8.
/// The mass matrix takes part at Y_i, so that a stage is one evaluation with M + hγ D + (hγ)² K in the place of M. The
/// order conditions are those of the additive pair. The implicit one is L-stable, stiffly accurate, of stage order 2.
#include <array>
#include <limits>

#include "adaptive_stepper.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace imex {

constexpr std::size_t stages = 8;
using Row = std::array<double, stages>;

constexpr double gamma_ii = 2.0 / 9;
constexpr Row c = {0, 4.0 / 9, 0.75871412497179891, 0.11526943456404197, 0.3567571284043185, 0.72, 0.955, 1};
/// Explicit tableau, rows 2 to 8.
constexpr std::array<Row, stages - 1> a_explicit = {{
    {4.0 / 9},
    {1.0 / 9, 0.64760301386068775},
    {0.091829866647747907, 0.035448567517799241, -0.012008999601505184},
    {-0.34252354516023137, -0.26767785943050182, 0.11056894178117282, 0.85638959121387881},
    {-0.0097722828790043955, 0.21070865398661751, 0.075924120912175361, 0.20765518596381696, 0.23548432201639455},
    {0.46686370681500694, 1.2903598800650855, 0.37840596884419414, -0.56345584032826157, -0.2883238346202236,
     -0.32884988077580141},
    {0.61439671625166914, 0.61439671625166914, 0.31747780106686158, -0.71215206239529361, 0.11498708015310211,
     0.09139031575415682, -0.040496567082165244},
}};
/// Implicit tableau, rows 2 to 8, without the diagonal γ; the last row with it is b.
constexpr std::array<Row, stages - 1> a_implicit = {{
    {2.0 / 9},
    {0.26824595137478835, 0.26824595137478835},
    {-0.057945592237231995, -0.057945592237231995, 0.0089383968162837328},
    {-0.043305287723547685, -0.043305287723547685, -0.034013891077568637, 0.25515937270676026},
    {0.13179599023759678, 0.13179599023759678, -0.032376726277862332, 0.12385474427672251, 0.14270777930372408},
    {0.30932282100434261, 0.30932282100434261, -0.68291992723367922, -0.058822756149695461, -0.041308613833499437,
     0.89718343298596659},
    {0, 0, 0.17366253573581261, 0.25479166260812353, 0.24190176845094791, 0.30740485830222825, -0.19998304731933453},
}};
/// The embedded method of order 4.
constexpr Row b_low = {0,
                       0,
                       0.062724216952707135,
                       0.25523315714677963,
                       0.23902754916001318,
                       0.39907952207535802,
                       -0.14315725125850667,
                       0.18709280592364871};

/// Where modes are not resolved the estimate goes up and down with them: 0.9 had a fifth of the spacecraft's steps
/// rejected, 0.8 one in fifty.
constexpr double safety = 0.8;

class ImexStepper final : public AdaptiveStepper {
 public:
  static constexpr int order = 5;
  static constexpr double stability_limit = std::numeric_limits<double>::infinity();

  ImexStepper(const EquationsOfMotion& equations, const State& start, const StepControl& control)
      : AdaptiveStepper(equations, start, control, 5, 6, safety), linear_(solver_of(equations, "imex")) {
    for (Eigen::ArrayXd* a : {&stage_, &base_, &saved_.y, &saved_.slope, &older_.y, &older_.slope}) a->setZero(size());
    for (Eigen::ArrayXd& k : k_) k.setZero(size());
  }

  void restart() override {
    AdaptiveStepper::restart();
    saved_.known = false;
  }

 private:
  /// An end of an earlier step.
  struct Node {
    bool known = false;
    double time = 0;
    Eigen::ArrayXd y, slope;
  };

  Trial attempt(double h) override {
    k_[0] = slope_;
    for (std::size_t i = 1; i < stages; ++i) {
      stage_ = y();
      base_ = y();
      for (std::size_t j = 0; j < i; ++j) {
        stage_ += h * a_explicit[i - 1][j] * k_[j];
        base_ += h * a_implicit[i - 1][j] * k_[j];
      }
      const Evaluation e = evaluate_implicit(linear_, state_.time + c[i] * h, stage_, base_, h * gamma_ii, k_[i]);
      if (!e.ok()) return {e};
    }
    next_ = base_ + h * gamma_ii * k_[stages - 1];
    normalize(next_);
    error_ = h * (gamma_ii - b_low[stages - 1]) * k_[stages - 1];
    for (std::size_t j = 2; j + 1 < stages; ++j) error_ += h * (a_implicit.back()[j] - b_low[j]) * k_[j];
    Trial trial{{}, error_ratio()};
    if (!(trial.error > 1)) trial.evaluation = evaluate(state_.time + h, next_, next_slope_);
    return trial;
  }

  void accepted(double /*h*/) override {
    std::swap(older_, saved_);
    saved_.known = true;
    saved_.time = previous_time_;
    saved_.y = previous_;
    saved_.slope = previous_slope_;
  }

  /// The quintic through values and slopes at the ends of this step and of the one before: error O(h⁶). After a start
  /// or a jump there is none before: the cubic, O(h⁴).
  void inside(double theta, Values values) const override {
    if (!older_.known) return cubic(theta, values);
    const std::array<double, 3> at = {older_.time, previous_time_, state_.time};
    const double t = at[1] + theta * (at[2] - at[1]);
    // From the values at the start: what does not change is left to the bit, though a sum of basis functions is only
    // nearly 1.
    values = previous_;
    const auto add = [&](std::size_t i, const auto& y, const auto& slope) {
      // Hermite's basis from Lagrange's.
      double basis = 1, rate = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        if (j == i) continue;
        basis *= (t - at[j]) / (at[i] - at[j]);
        rate += 1 / (at[i] - at[j]);
      }
      values += basis * basis * ((1 - 2 * rate * (t - at[i])) * (y - previous_) + (t - at[i]) * slope);
    };
    add(0, older_.y, older_.slope);
    add(1, previous_, previous_slope_);
    add(2, y(), slope_);
  }

  void remember(Memory& memory) override {
    AdaptiveStepper::remember(memory);
    memory(saved_.known);
    memory(saved_.time);
    memory(saved_.y);
    memory(saved_.slope);
  }

  const LinearlyImplicit& linear_;
  std::array<Eigen::ArrayXd, stages> k_;
  Eigen::ArrayXd stage_, base_;  ///< Y_i, and Z_i without its last term
  Node saved_;                   ///< the start of the last step
  Node older_;                   ///< the start of the step before it
};

}  // namespace imex

void enroll_imex(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "imex",
       .summary = "Semi-implicit Runge-Kutta method of order 5, L-stable: stiffness and damping implicit at the price "
                  "of an explicit stage",
       .parameters = step_control_parameters(),
       .make = &make_controlled<imex::ImexStepper>});
}

}  // namespace withy
