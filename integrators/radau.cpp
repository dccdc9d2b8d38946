/// \file
/// Radau IIA of order 5 with three stages, after RADAU5 (Hairer & Wanner, "Solving Ordinary Differential Equations II",
/// IV.8): L-stable, stiffly accurate; simplified Newton iteration with one real and one complex factorization, which
/// serve several steps; error estimate of order 3; between the steps the collocation polynomial.
#include "adaptive_stepper.hpp"
#include "collocation.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

struct RadauOptions {
  StepControl control;
  StepJacobian::Source jacobian = StepJacobian::Source::differences;
  double iteration = 0.03;  ///< error of the iteration over the tolerance
};

/// The estimate is of order 4 in h, the result of order 5: steps for tolerances raised to 4/5 give errors proportional
/// to the tolerance asked for. The constant is such that they are below it on the conformance suite's oscillator.
StepControl raised(StepControl control) {
  const double factor = 0.15 * std::pow(control.rtol, -0.2);
  control.rtol *= factor;
  control.atol *= factor;
  return control;
}

class RadauStepper final : public AdaptiveStepper {
 public:
  RadauStepper(const EquationsOfMotion& equations, const State& start, const RadauOptions& options)
      : AdaptiveStepper(equations, start, raised(options.control), 4),
        options_(options),
        jacobian_(equations, options.jacobian),
        stages_(Collocation::radau_iia(), jacobian_),
        tolerance_(Eigen::ArrayXd::Zero(size())),
        trial_(Eigen::ArrayXd::Zero(size())),
        filtered_(Eigen::VectorXd::Zero(jacobian_.size())),
        kept_(Eigen::MatrixXd::Zero(jacobian_.size(), 3)) {}

  void restart() override {
    AdaptiveStepper::restart();
    known_ = fresh_ = false;
    first_ = true;
    stages_.forget();
  }
  [[nodiscard]] std::vector<std::string> remarks() const override { return jacobian_.remarks(); }

 private:
  static constexpr int most_iterations = 7;

  Trial attempt(double h) override {
    const Eigen::Index m = jacobian_.size(), work = size() - 1;
    const double t = state_.time;
    if (m == 0) {
      next_ = y() + h * slope_;
      return {evaluate(t + h, next_, next_slope_), 0};
    }
    const auto rates = [this](double at, const Eigen::ArrayXd& values, Eigen::ArrayXd& slope) {
      return evaluate(at, values, slope);
    };
    tolerance_ = options_.iteration * (options_.control.atol + options_.control.rtol * y().abs()) +
                 16 * std::numeric_limits<double>::epsilon() * (y().abs() + h * slope_.abs());
    CollocationStages::Result r;
    do {
      if (!known_) {
        if (const Evaluation e = jacobian_.update(t, h, y(), slope_, rates, options_.control.atol); !e.ok()) return {e};
        known_ = fresh_ = true;
        stages_.refactorize();
      }
      stages_.factorize(h);
      stages_.predict(h);
      r = stages_.solve(t, h, y(), tolerance_, most_iterations, rates);
      // Where the run begins, what is guessed to stay may be far from any motion, in steps however short: a mean since
      // the start is the quotient of a sum and a time, which are zero there together.
      if (first_ && r.end == CollocationStages::End::slow) {
        stages_.predict_along(h, slope_);
        r = stages_.solve(t, h, y(), tolerance_, most_iterations, rates);
      }
      if (r.end == CollocationStages::End::converged) break;
      stages_.accept(0);  // what these stages are predicts nothing
      if (r.end == CollocationStages::End::failed && fresh_) return {r.evaluation};
      known_ = false;
    } while (!fresh_);
    // No convergence with a Jacobian of this very state: half the step.
    if (r.end != CollocationStages::End::converged) {
      known_ = true;
      return {{}, unsolved};
    }
    if (r.rate > slow_rate) stale_ = true;
    // The power is that of the stages before the last correction, which for what is linear is the only one.
    if (work_counts()) r = stages_.solve(t, h, y(), tolerance_, most_iterations, rates);
    if (r.end != CollocationStages::End::converged) return {r.evaluation, unsolved};

    const Eigen::MatrixXd& z = stages_.z();
    next_ = y();
    next_.head(m) += z.col(2).array();
    next_[work] += h * stages_.slopes().row(work).dot(Collocation::radau_iia().b);
    normalize(next_);
    estimate(z, h, slope_);
    double ratio = error_ratio();
    if (ratio >= 1 && (first_ || rejected_)) {
      trial_ = y() + error_;
      if (const Evaluation e = evaluate(t, trial_, next_slope_); !e.ok()) return {e};
      estimate(z, h, next_slope_);
      ratio = error_ratio();
    }
    rejected_ = ratio > 1;
    if (rejected_) {
      stages_.accept(0);
      return {{}, ratio};
    }
    return {evaluate(t + h, next_, next_slope_), ratio};
  }

  /// With J = ∂f/∂y, whose accelerations keep the rates at which loops open, μ (μ − J)⁻¹ changes nothing of how far a
  /// change of positions, or of speeds, closes loops. Of M⁻¹ Gᵀ c it makes (M + D/μ + K/μ²)⁻¹ Gᵀ c of speeds, and of
  /// positions the same with M + D/μ before it: twice, what damping has left of stiff modes goes too.
  bool soften(Eigen::ArrayXd& change) const override {
    const auto soften_part = [&](Eigen::Index from, Eigen::Index count) {
      filtered_.setZero();
      filtered_.segment(from, count) = stages_.real_system().shift() * change.segment(from, count).matrix();
      stages_.real_system().solve(filtered_);
      change.segment(from, count) = filtered_.segment(from, count).array();
    };
    soften_part(0, jacobian_.positions());
    soften_part(0, jacobian_.positions());
    soften_part(jacobian_.positions(), jacobian_.speeds());
    return true;
  }

  /// (γ/h − J)⁻¹ (f + Σ e_i z_i / h), bounded where h J is large (IV.8, equation 8.19).
  void estimate(const Eigen::MatrixXd& z, double h, const Eigen::ArrayXd& slope) {
    static const Eigen::Vector3d e{-(13 + 7 * std::sqrt(6.0)) / 3, (-13 + 7 * std::sqrt(6.0)) / 3, -1.0 / 3};
    filtered_.noalias() = z * e;
    filtered_ = filtered_ / h + slope.head(jacobian_.size()).matrix();
    stages_.real_system().solve(filtered_);
    error_.head(jacobian_.size()) = filtered_.array();
    // Nothing depends on the work: of it the same with J = 0.
    const Eigen::Index work = size() - 1;
    const Collocation& method = Collocation::radau_iia();
    error_[work] = h / method.gamma * (slope[work] + e.dot(method.A * stages_.slopes().row(work).transpose()));
  }

  void accepted(double h) override {
    stages_.accept(h);
    kept_ = stages_.z();
    first_ = rejected_ = fresh_ = false;
    if (stale_) known_ = stale_ = false;
  }
  /// A step hardly longer is not worth new factors.
  double favoured(double wanted, double h) const override { return wanted >= h && wanted <= 1.2 * h ? h : wanted; }

  void inside(double theta, Values values) const override {
    const Eigen::Index m = jacobian_.size();
    cubic(theta, values);  // of which the work element remains
    const Eigen::Vector3d w = stages_.weights_at(theta);
    for (Eigen::Index i = 0; i < m; ++i) values[i] = previous_[i] + kept_.row(i) * w;
  }

  void remember(Memory& memory) override {
    AdaptiveStepper::remember(memory);
    jacobian_.remember(memory);
    stages_.remember(memory);
    memory(known_);
    memory(stale_);
    memory(first_);
    memory(rejected_);
  }

  static constexpr double slow_rate = 0.05;  ///< of convergence, from which a new Jacobian pays
  static constexpr double unsolved = 16;     ///< error ratio that halves the step, about

  RadauOptions options_;
  StepJacobian jacobian_;
  CollocationStages stages_;
  Eigen::ArrayXd tolerance_, trial_;
  mutable Eigen::VectorXd filtered_;
  Eigen::MatrixXd kept_;                                ///< stages of the last accepted step
  bool known_ = false, fresh_ = false, stale_ = false;  ///< the Jacobian: is there; of this state; to be found anew
  bool first_ = true, rejected_ = false;                ///< no step since the start; the last trial was too inaccurate
};

class Radau final : public Integrator {
 public:
  explicit Radau(const RadauOptions& options) : options_(options) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<RadauStepper>(equations, state, options_);
  }
  int order() const override { return 5; }
  std::optional<double> stability_limit() const override { return std::numeric_limits<double>::infinity(); }

 private:
  RadauOptions options_;
};

std::unique_ptr<Integrator> make_radau(const Value& p, const MakeContext& context) {
  const std::optional<StepControl> control = read_step_control(p, context);
  if (!control) return nullptr;
  return std::make_unique<Radau>(RadauOptions{*control, jacobian_source(p), p.number_at("iteration_error")});
}

std::vector<ParameterSpec> parameters() {
  std::vector<ParameterSpec> all = step_control_parameters();
  all.push_back(jacobian_parameter());
  all.push_back(number("iteration_error", "1", "error left by the iteration for the stages, over the tolerance")
                    .above(0)
                    .most(1)
                    .otherwise(0.03));
  return all;
}

}  // namespace

void enroll_radau(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "radau",
       .summary = "Radau IIA of order 5, fully implicit, L-stable: for what is stiff, at any accuracy",
       .parameters = parameters(),
       .make = &make_radau});
}

}  // namespace withy
