/// \file
/// The generalized-α method of Chung & Hulbert (J. Applied Mechanics 60, 1993, 371–375) with equal steps; with αm = 0
/// that of Hilber, Hughes & Taylor. In the form of Arnold & Brüls (Multibody System Dynamics 18, 2007, 185–202), whose
/// auxiliary accelerations a keep order 2 where the mass matrix depends on the positions:
///   (1 − αm) a₁ + αm a₀ = (1 − αf) u̇₁ + αf u̇₀,   u₁ = u₀ + h ((1 − γ) a₀ + γ a₁),
///   x₁ = x₀ moved for h with the speeds Δ = u₀ + h ((½ − β) a₀ + β a₁).
/// Continuous states of loads are taken as speeds are, with rates of their own in the place of a (Jansen, Whiting &
/// Hulbert, Comput. Methods Appl. Mech. Engrg. 190, 2000, 305–319, with the α of the second-order method).
#include "equal_steps.hpp"
#include "jacobian.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

struct AlphaParameters {
  double alpha_m = 0, alpha_f = 0;
  [[nodiscard]] double gamma() const { return 0.5 - alpha_m + alpha_f; }
  [[nodiscard]] double beta() const {
    const double a = 1 - alpha_m + alpha_f;
    return a * a / 4;
  }
  static AlphaParameters chung_hulbert(double rho) { return {(2 * rho - 1) / (rho + 1), rho / (rho + 1)}; }
  static AlphaParameters hht(double rho) { return {0, (1 - rho) / (1 + rho)}; }
};

struct AlphaOptions {
  double step = 0;
  AlphaParameters parameters;
  StepJacobian::Source jacobian = StepJacobian::Source::differences;
};

class AlphaStepper final : public EqualSteps {
 public:
  AlphaStepper(const EquationsOfMotion& equations, const State& start, const AlphaOptions& options)
      : EqualSteps(equations, start, options.step),
        equations_of_motion_(equations),
        parameters_(options.parameters),
        jacobian_(equations, options.jacobian),
        motion_work_(equations.make_work()),
        sizes_(size()),
        matrix_(Eigen::MatrixXd::Identity(jacobian_.rates(), jacobian_.rates())),
        lu_(matrix_) {
    for (Eigen::ArrayXd* a : {&moving_, &rate_, &lost_, &lost_next_}) a->setZero(size());
    for (Eigen::VectorXd* a : {&a0_, &a1_, &residual_}) a->setZero(jacobian_.rates());
    moved_.setZero(jacobian_.positions());
  }

  void restart() override {
    EqualSteps::restart();
    known_ = begun_ = false;
    factored_ = 0;
    sizes_.forget();
    lost_.setZero();
  }
  [[nodiscard]] std::vector<std::string> remarks() const override { return with_unsolved(jacobian_.remarks()); }

 private:
  static constexpr int most_iterations = 20;
  static constexpr int slow = 6;             ///< iterations that make a new Jacobian worth while
  static constexpr double accuracy = 1e-13;  ///< of the iteration, relative to the sizes of positions and speeds

  Evaluation attempt(double h) override {
    const Eigen::Index np = jacobian_.positions(), n = jacobian_.rates();
    const double t = state_.time;
    if (!begun_) {
      a0_ = slope_.segment(np, n).matrix();
      begun_ = true;
    }
    const auto ahead = [this, h]() -> const Eigen::ArrayXd& { return slope_ahead(h); };
    const Eigen::ArrayXd& sizes = sizes_.update(y(), h, slope_, ahead);
    const auto rates = [this](double at, const Eigen::ArrayXd& values, Eigen::ArrayXd& slope) {
      return evaluate(at, values, slope);
    };
    for (bool fresh = false;;) {
      if (!known_) {
        if (const Evaluation e = jacobian_.update(t, h, y(), slope_, rates); !e.ok()) return e;
        known_ = fresh = true;
        factored_ = 0;
      }
      factorize(h);
      a1_ = a0_;
      int iterations = 0;
      bool converged = n == 0, failed = false;
      Evaluation evaluation = n == 0 ? move(h) : Evaluation{};
      if (n == 0 && evaluation.ok()) evaluation = evaluate(t + h, next_, next_slope_);
      double last = std::numeric_limits<double>::infinity();
      while (!converged && ++iterations <= most_iterations) {
        if (evaluation = move(h); !evaluation.ok()) break;
        if (evaluation = evaluate(t + h, next_, next_slope_); !evaluation.ok()) break;
        const AlphaParameters& p = parameters_;
        residual_ = (1 - p.alpha_f) * next_slope_.segment(np, n).matrix() + p.alpha_f * slope_.segment(np, n).matrix() -
                    (1 - p.alpha_m) * a1_ - p.alpha_m * a0_;
        residual_ = lu_.solve(residual_);
        a1_ += residual_;
        // Of the speeds and, which is more where h ω is large, of the positions.
        moved_.noalias() = jacobian_.matrix().topRightCorner(np, n) * residual_;
        double change = h * p.gamma() * (residual_.array().abs() / sizes.segment(np, n)).maxCoeff();
        if (np > 0) change = std::max(change, h * h * p.beta() * (moved_.array().abs() / sizes.head(np)).maxCoeff());
        if (!std::isfinite(change)) {
          evaluation = {Evaluation::Outcome::nonfinite, -1};
          break;
        }
        converged = change <= accuracy || (change >= last && change <= 1e-9);
        failed = iterations > 2 && change > 2 * last;
        if (failed) break;
        last = change;
      }
      if (converged && evaluation.ok()) {
        if (iterations > slow) known_ = false;
        break;
      }
      if (fresh) return evaluation.ok() ? unsolved(evaluation) : evaluation;
      known_ = false;
    }
    // The last change of a is too small to need another evaluation for the slope, but the state has it.
    if (const Evaluation e = move(h); !e.ok()) return e;
    return evaluate(t + h, next_, next_slope_);
  }

  /// next_ for a1_. By the midpoint rule, then normalized: for quaternions of third order in h |Δ|, exact where ẋ = u.
  Evaluation move(double h) {
    const Eigen::Index np = jacobian_.positions(), n = jacobian_.rates();
    const double beta = parameters_.beta(), gamma = parameters_.gamma();
    moving_ = y();
    moving_.segment(np, n) += (h * ((0.5 - beta) * a0_ + beta * a1_)).array();
    const auto count = static_cast<std::size_t>(size());
    const auto position_rates = [&](const Eigen::ArrayXd& at) {
      return equations_of_motion_.position_rates(state_.time, {at.data(), count}, {rate_.data(), count}, motion_work_);
    };
    if (const Evaluation e = position_rates(moving_); !e.ok()) return e;
    if (!jacobian_.second_order()) {
      moving_.head(np) += h / 2 * rate_.head(np);
      if (const Evaluation e = position_rates(moving_); !e.ok()) return e;
    }
    // What earlier sums lost is added, and what this one loses kept, as in `gauss`.
    moving_ = lost_;
    moving_.head(np) += h * rate_.head(np);
    moving_.segment(np, n) += (h * ((1 - gamma) * a0_ + gamma * a1_)).array();
    next_ = y() + moving_;
    lost_next_ = moving_ - (next_ - y());
    normalize(next_);
    return {};
  }

  void factorize(double h) {
    if (factored_ == h) return;
    factored_ = h;
    const AlphaParameters& p = parameters_;
    const Eigen::Index np = jacobian_.positions(), n = jacobian_.rates();
    const auto J = jacobian_.matrix();
    matrix_ = h * p.gamma() * J.bottomRightCorner(n, n);
    matrix_.noalias() += h * h * p.beta() * J.bottomLeftCorner(n, np) * J.topRightCorner(np, n);
    matrix_ *= -(1 - p.alpha_f);
    matrix_.diagonal().array() += 1 - p.alpha_m;
    lu_.compute(matrix_);
  }

  void accepted(double h) override {
    a0_.swap(a1_);
    lost_.swap(lost_next_);
    // Work by the trapezoidal rule, whose order is the method's.
    const auto last = static_cast<std::size_t>(size() - 1);
    state_.y[last] += h / 2 * (previous_slope_[size() - 1] + slope_[size() - 1]);
  }
  [[nodiscard]] int most_halvings() const override { return 19; }

  void inside(double theta, Values values) const override { cubic(theta, values); }

  void remember(Memory& memory) override {
    EqualSteps::remember(memory);
    jacobian_.remember(memory);
    sizes_.remember(memory);
    memory(lost_);
    memory(a0_);
    memory(known_);
    memory(begun_);
    if (memory.reading()) factored_ = 0;
  }

  const EquationsOfMotion& equations_of_motion_;
  AlphaParameters parameters_;
  StepJacobian jacobian_;
  Work motion_work_;
  Sizes sizes_;
  Eigen::MatrixXd matrix_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  double factored_ = 0;                 ///< step of lu_ [s]
  bool known_ = false, begun_ = false;  ///< the Jacobian; a0_
  Eigen::ArrayXd moving_, rate_, lost_, lost_next_;
  Eigen::VectorXd a0_, a1_, residual_, moved_;
};

class GeneralizedAlpha final : public Integrator {
 public:
  explicit GeneralizedAlpha(const AlphaOptions& options) : options_(options) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr)
      refuse_loops("generalized-alpha", "it keeps accelerations of its own, which closing would not change");
    return std::make_unique<AlphaStepper>(equations, state, options_);
  }
  int order() const override { return 2; }
  std::optional<double> stability_limit() const override { return std::numeric_limits<double>::infinity(); }

 private:
  AlphaOptions options_;
};

std::unique_ptr<Integrator> make_generalized_alpha(const Value& p, const MakeContext& context) {
  const double rho = p.number_at("rho_infinity");
  const bool hht = p.at("method").text() == "hht";
  if (hht && rho < 0.5) {
    context.diagnostics.error(p.at("rho_infinity").place(), "hht needs a rho_infinity of 0.5 to 1");
    return nullptr;
  }
  return std::make_unique<GeneralizedAlpha>(AlphaOptions{
      p.number_at("step"), hht ? AlphaParameters::hht(rho) : AlphaParameters::chung_hulbert(rho), jacobian_source(p)});
}

}  // namespace

void enroll_generalized_alpha(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "generalized-alpha",
       .summary = "Generalized-alpha method of order 2, equal steps, with the numerical damping one chooses",
       .parameters = {step_parameter(),
                      number("rho_infinity", "1",
                             "factor a step by which infinitely fast vibrations shrink: 1 none, 0 at once")
                          .least(0)
                          .most(1)
                          .otherwise(0.8),
                      text("method", "Chung and Hulbert's, or that of Hilber, Hughes and Taylor")
                          .one_of({"chung-hulbert", "hht"})
                          .otherwise("chung-hulbert"),
                      jacobian_parameter()},
       .make = &make_generalized_alpha});
}

}  // namespace withy
