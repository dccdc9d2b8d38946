/// \file
/// Gauss collocation of order 6 with three stages and equal steps (Hairer, Lubich & Wanner, "Geometric Numerical
/// Integration", II.1.3): symmetric, and symplectic in canonical variables. The stages are iterated to rounding and the
/// steps summed with compensation (VIII.5 and Hairer, McLachlan & Razakarivony, BIT 48, 2008).
#include "collocation.hpp"
#include "equal_steps.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

class GaussStepper final : public EqualSteps {
 public:
  GaussStepper(const EquationsOfMotion& equations, const State& start, double step, StepJacobian::Source source)
      : EqualSteps(equations, start, step),
        jacobian_(equations, source),
        stages_(Collocation::gauss(), jacobian_),
        sizes_(size()),
        tolerance_(Eigen::ArrayXd::Zero(size())),
        lost_(Eigen::ArrayXd::Zero(size())),
        lost_next_(Eigen::ArrayXd::Zero(size())) {}

  void restart() override {
    EqualSteps::restart();
    known_ = false;
    stages_.forget();
    sizes_.forget();
    lost_.setZero();
  }
  [[nodiscard]] std::vector<std::string> remarks() const override { return with_unsolved(jacobian_.remarks()); }
  [[nodiscard]] WorkGap greatest_gap() const override { return gap_; }

 private:
  static constexpr int most_iterations = 50;
  static constexpr int slow = 12;  ///< iterations that make a new Jacobian worth while

  Evaluation attempt(double h) override {
    const Eigen::Index m = jacobian_.size();
    const double t = state_.time;
    if (m == 0) {
      next_ = y() + h * slope_;
      return evaluate(t + h, next_, next_slope_);
    }
    const auto rates = [this](double at, const Eigen::ArrayXd& values, Eigen::ArrayXd& slope) {
      return evaluate(at, values, slope);
    };
    const auto ahead = [this, h]() -> const Eigen::ArrayXd& { return slope_ahead(h); };
    tolerance_ = 4 * std::numeric_limits<double>::epsilon() * sizes_.update(y(), h, slope_, ahead);
    CollocationStages::Result r;
    for (bool fresh = false;;) {
      if (!known_) {
        if (const Evaluation e = jacobian_.update(t, h, y(), slope_, rates); !e.ok()) return e;
        known_ = fresh = true;
        stages_.refactorize();
      }
      stages_.factorize(h);
      stages_.predict(h);
      r = stages_.solve_to_rounding(t, h, y(), tolerance_, most_iterations, rates);
      if (r.end == CollocationStages::End::converged) break;
      stages_.accept(0);
      if (fresh) return r.end == CollocationStages::End::slow ? unsolved(r.evaluation) : r.evaluation;
      known_ = false;
    }
    if (r.iterations > slow) known_ = false;

    stages_.end_of_step(h, state_.y, lost_, next_, lost_next_);
    normalize(next_);
    return evaluate(t + h, next_, next_slope_);
  }

  void accepted(double h) override {
    stages_.accept(h);
    lost_.swap(lost_next_);
    const Eigen::Index work = size() - 1;
    if (jacobian_.size() == 0) return;
    const double middle = stages_.slopes()(work, 1), ends = previous_slope_[work] + slope_[work];
    const double gap = std::abs(y()[work] - previous_[work] - h / 6 * (ends + 4 * middle));
    if (gap > gap_.work) gap_ = {gap, state_.time, h};
  }
  [[nodiscard]] int most_halvings() const override { return 19; }

  void inside(double theta, Values values) const override { cubic(theta, values); }

  void remember(Memory& memory) override {
    EqualSteps::remember(memory);
    jacobian_.remember(memory);
    stages_.remember(memory);
    sizes_.remember(memory);
    memory(lost_);
    memory(known_);
    memory(gap_.work);
    memory(gap_.time);
    memory(gap_.step);
  }

  StepJacobian jacobian_;
  CollocationStages stages_;
  Sizes sizes_;
  Eigen::ArrayXd tolerance_, lost_, lost_next_;
  bool known_ = false;  ///< the Jacobian
  WorkGap gap_;
};

class Gauss final : public Integrator {
 public:
  Gauss(double step, StepJacobian::Source source) : step_(step), source_(source) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<GaussStepper>(equations, state, step_, source_);
  }
  int order() const override { return 6; }
  std::optional<double> stability_limit() const override { return std::numeric_limits<double>::infinity(); }

 private:
  double step_;
  StepJacobian::Source source_;
};

}  // namespace

void enroll_gauss(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "gauss",
       .summary = "Gauss collocation of order 6, equal steps, symmetric: keeps the energy of undamped motion",
       .parameters = {step_parameter(), jacobian_parameter()},
       .make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Integrator> {
         return std::make_unique<Gauss>(p.number_at("step"), jacobian_source(p));
       }});
}

}  // namespace withy
