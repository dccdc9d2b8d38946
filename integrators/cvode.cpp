/// \file
/// CVODE of SUNDIALS (Hindmarsh et al., ACM Trans. Math. Software 31, 2005): multistep methods of variable order and
/// step, backward differentiation (orders 1 to 5) or Adams–Moulton (1 to 12), with Newton's iteration.
#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "cvode_history.hpp"
#include "cvode_tolerance.hpp"
#include "jacobian.hpp"
#include "step_control.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/discrete_states.hpp"
#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/just_before.hpp"

namespace withy {
namespace {

struct CvodeOptions {
  StepControl control;
  bool stiff = true;
  StepJacobian::Source jacobian = StepJacobian::Source::differences;
};

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* p) const {
    Free(p);
  }
};
void free_context(SUNContext context) { SUNContext_Free(&context); }
void free_memory(void* memory) { CVodeFree(&memory); }
using Context = std::unique_ptr<_SUNContext, Freed<&free_context>>;
using Vector = std::unique_ptr<_generic_N_Vector, Freed<&N_VDestroy>>;
using Matrix = std::unique_ptr<_generic_SUNMatrix, Freed<&SUNMatDestroy>>;
using LinearSolver = std::unique_ptr<_generic_SUNLinearSolver, Freed<&SUNLinSolFree>>;
using CvodeMemory = std::unique_ptr<void, Freed<&free_memory>>;

Context new_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
  return Context(context);
}

class CvodeStepper final : public Stepper {
 public:
  CvodeStepper(const EquationsOfMotion& equations, const State& start, const CvodeOptions& options)
      : equations_(equations),
        jacobian_(equations, options.jacobian),
        tolerance_(options.control, options.stiff, start.y.size()),
        work_(equations.make_work()),
        context_(new_context()) {
    place(start);
    equations_.normalize(state_.y);
    previous_ = state_.y;
    const auto n = static_cast<sunindextype>(state_.y.size());
    slope_.resize(n);
    y_.reset(N_VNew_Serial(n, context_.get()));
    inside_.reset(N_VNew_Serial(n, context_.get()));
    matrix_.reset(SUNDenseMatrix(n, n, context_.get()));
    solver_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context_.get()));
    cvode_.reset(CVodeCreate(options.stiff ? CV_BDF : CV_ADAMS, context_.get()));
    const Vector tolerance(N_VNew_Serial(n, context_.get()));
    if (!y_ || !inside_ || !matrix_ || !solver_ || !cvode_ || !tolerance) throw std::bad_alloc();
    N_VConst(tolerance_.atol, tolerance.get());
    const Layout& layout = equations_.layout();
    // The work has no part in the error, but where nothing else is left to find.
    if (layout.prescribed < layout.speeds) NV_Ith_S(tolerance.get(), n - 1) = 1e300;
    std::copy(state_.y.begin(), state_.y.end(), N_VGetArrayPointer(y_.get()));
    void* c = cvode_.get();
    const StepControl& control = options.control;
    const bool good =
        CVodeSetErrFile(c, nullptr) == CV_SUCCESS &&  // outcomes tell
        CVodeInit(c, &rates, state_.time, y_.get()) == CV_SUCCESS && CVodeSetUserData(c, this) == CV_SUCCESS &&
        CVodeSVtolerances(c, tolerance_.rtol, tolerance.get()) == CV_SUCCESS &&
        CVodeSetLinearSolver(c, solver_.get(), matrix_.get()) == CV_SUCCESS &&
        CVodeSetJacFn(c, &jacobian) == CV_SUCCESS && CVodeSetMaxHnilWarns(c, -1) == CV_SUCCESS &&
        CVodeSetInitStep(c, control.initial_step) == CV_SUCCESS && CVodeSetMinStep(c, control.min_step) == CV_SUCCESS &&
        (!std::isfinite(control.max_step) || CVodeSetMaxStep(c, control.max_step) == CV_SUCCESS);
    if (!good) throw std::runtime_error("CVODE does not take these options");
  }

  StepResult step(double t_limit) override {
    if (!(t_limit > state_.time)) return {};
    latest_ = just_before(t_limit, state_.time);
    failed_ = {};
    const double rounding = std::numeric_limits<double>::epsilon() * std::max(std::abs(state_.time), std::abs(t_limit));
    if (t_limit - state_.time <= 100 * rounding) return hop(t_limit);
    if (begin_) {
      std::copy(state_.y.begin(), state_.y.end(), N_VGetArrayPointer(y_.get()));
      CVodeReInit(cvode_.get(), state_.time, y_.get());
      history_.begin(state_);
      begin_ = false;
      failures_ = 0;
    }
    CVodeSetStopTime(cvode_.get(), t_limit);
    double t = state_.time;
    const int flag = CVode(cvode_.get(), t_limit, y_.get(), &t, CV_ONE_STEP);
    count_rejections();
    if (flag < 0) {
      begin_ = true;
      return failure();
    }
    const double* values = N_VGetArrayPointer(y_.get());
    if (!(t > state_.time)) return failure();
    history_.add(t_limit);
    begin_ = history_.steps() == most_steps_of_history;
    return accept(t, {values, state_.y.size()});
  }

  [[nodiscard]] const State& state() const override { return state_; }
  [[nodiscard]] const StepStatistics& statistics() const override { return statistics_; }
  void interpolate(double t, std::span<double> out) const override {
    if (t >= state_.time) {
      std::copy(state_.y.begin(), state_.y.end(), out.begin());
    } else if (t <= previous_time_ || CVodeGetDky(cvode_.get(), t, 0, inside_.get()) != CV_SUCCESS) {
      std::copy(previous_.begin(), previous_.end(), out.begin());
    } else {
      std::copy_n(N_VGetArrayPointer(inside_.get()), out.size(), out.begin());
      keep_discrete_states(equations_.layout(), state_.y, out);
      equations_.normalize(out);
    }
  }
  void restart() override { begin_ = true; }
  void jump(const State& state) override {
    place(state);
    begin_ = true;
  }
  // CVODE keeps its history to itself. What made it is remembered instead: where CVODE last began, and the steps since,
  // which are made again. That it begins anew after a fixed number of steps bounds them.
  [[nodiscard]] std::vector<double> memory() const override {
    Memory memory;
    const_cast<CvodeStepper*>(this)->remember(memory);  // which only reads them, since it writes
    return memory.numbers();
  }
  void resume(const State& state, std::span<const double> numbers) override {
    Memory memory(numbers);
    remember(memory);
    memory.finish();
    const StepStatistics statistics = statistics_;
    const int sign = sign_;
    if (begin_) {
      place(state);
    } else {
      const CvodeHistory made = history_;
      place(made.start());
      begin_ = true;
      for (const CvodeHistory::Stretch& stretch : made.stretches())
        for (std::size_t i = 0; i < stretch.steps; ++i)
          if (step(stretch.limit).outcome != StepResult::Outcome::ok)
            throw std::invalid_argument("a step of the checkpoint cannot be made again");
      if (state_.time != state.time || state_.y != state.y)
        throw std::invalid_argument("the steps to the checkpoint, made again, lead to another state");
    }
    statistics_ = statistics;
    sign_ = sign;
  }
  [[nodiscard]] std::vector<std::string> remarks() const override {
    std::vector<std::string> all = jacobian_.remarks();
    if (!tolerance_.remark.empty()) all.push_back(tolerance_.remark);
    return all;
  }

 private:
  void place(const State& state) {
    if (state.y.size() != equations_.size())
      throw std::invalid_argument("the state has " + std::to_string(state.y.size()) + " numbers, the equations need " +
                                  std::to_string(equations_.size()));
    state_ = state;
    previous_time_ = state.time;
    previous_ = state.y;
  }
  StepResult accept(double t, std::span<const double> values) {
    const double h = t - state_.time;
    previous_time_ = state_.time;
    previous_ = state_.y;
    state_.time = t;
    std::copy(values.begin(), values.end(), state_.y.begin());
    equations_.normalize(state_.y);
    statistics_.smallest_step = statistics_.accepted == 0 ? h : std::min(statistics_.smallest_step, h);
    statistics_.largest_step = std::max(statistics_.largest_step, h);
    ++statistics_.accepted;
    statistics_.determinant_sign = sign_;
    return {};
  }
  /// Over an interval of a few roundings of time, as between two instants that are meant to be one, which CVODE takes
  /// for none: one step of Euler's method, and CVODE begins anew behind it.
  StepResult hop(double t_limit) {
    begin_ = true;
    std::copy(state_.y.begin(), state_.y.end(), N_VGetArrayPointer(y_.get()));
    if (rates(state_.time, y_.get(), inside_.get(), this) != 0) return failure();
    double* values = N_VGetArrayPointer(y_.get());
    const double* slope = N_VGetArrayPointer(inside_.get());
    for (std::size_t i = 0; i < state_.y.size(); ++i) values[i] = state_.y[i] + (t_limit - state_.time) * slope[i];
    return accept(t_limit, {values, state_.y.size()});
  }
  void remember(Memory& memory) {
    memory(statistics_.accepted);
    memory(statistics_.rejected);
    memory(statistics_.evaluations);
    memory(statistics_.smallest_step);
    memory(statistics_.largest_step);
    memory(statistics_.determinant_sign);
    memory(sign_);
    memory(begin_);
    history_.remember(memory);
  }
  void count_rejections() {
    long errors = 0, unsolved = 0;
    CVodeGetNumErrTestFails(cvode_.get(), &errors);
    CVodeGetNumNonlinSolvConvFails(cvode_.get(), &unsolved);
    statistics_.rejected += static_cast<std::size_t>(errors + unsolved - failures_);
    failures_ = errors + unsolved;
  }
  /// The evaluations of the step that failed are to blame, if any did: with shorter and shorter steps CVODE itself
  /// ends in complaints of many kinds.
  [[nodiscard]] StepResult failure() const {
    if (failed_.ok()) return {StepResult::Outcome::step_underflow, -1};
    const bool singular = failed_.outcome == Evaluation::Outcome::singular;
    return {singular ? StepResult::Outcome::singular : StepResult::Outcome::nonfinite, failed_.body};
  }

  Evaluation evaluate(double t, const double* y, double* f) {
    ++statistics_.evaluations;
    const std::size_t n = state_.y.size();
    Evaluation e = equations_.derivatives(std::min(t, latest_), {y, n}, {f, n}, work_);
    if (e.ok()) {
      double total = 0;
      for (std::size_t i = 0; i < n; ++i) total += f[i] * 0.0;
      if (total != 0.0) e = {Evaluation::Outcome::nonfinite, -1};
    }
    return e;
  }
  /// A return of 1 asks CVODE for a shorter step.
  int refuse(const Evaluation& e) {
    failed_ = e;
    return 1;
  }
  static int rates(double t, N_Vector y, N_Vector y_dot, void* self) {
    auto& s = *static_cast<CvodeStepper*>(self);
    const Evaluation e = s.evaluate(t, N_VGetArrayPointer(y), N_VGetArrayPointer(y_dot));
    s.sign_ = e.determinant_sign;
    return e.ok() ? 0 : s.refuse(e);
  }
  /// CVODE's own differences are, where y is zero, over h ẏ times some thousand roundings. It keeps a Jacobian for up
  /// to fifty steps, of which the first from rest are nearly nothing: what was rounding in those leaves corrections so
  /// small in the next that they count as converged, and a tree that a torque acts on stays at rest.
  static int jacobian(double t, N_Vector y, N_Vector y_dot, SUNMatrix matrix, void* self, N_Vector, N_Vector,
                      N_Vector) {
    auto& s = *static_cast<CvodeStepper*>(self);
    const auto n = static_cast<Eigen::Index>(s.state_.y.size()), m = s.jacobian_.size();
    s.slope_ = Eigen::Map<const Eigen::ArrayXd>(N_VGetArrayPointer(y_dot), n);
    double h = 0;
    CVodeGetCurrentStep(s.cvode_.get(), &h);
    const auto by = [&s](double at, const Eigen::ArrayXd& moved, Eigen::ArrayXd& slope) {
      return s.evaluate(at, moved.data(), slope.data());
    };
    const Evaluation e = s.jacobian_.update(std::min(t, s.latest_), h,
                                            Eigen::Map<const Eigen::ArrayXd>(N_VGetArrayPointer(y), n), s.slope_, by);
    if (!e.ok()) return s.refuse(e);
    // Discrete states, which are constant, and the work follow these.
    SUNMatZero(matrix);
    for (Eigen::Index j = 0; j < m; ++j)
      std::copy_n(s.jacobian_.matrix().col(j).data(), m, SUNDenseMatrix_Column(matrix, j));
    return 0;
  }

  const EquationsOfMotion& equations_;
  StepJacobian jacobian_;
  CalibratedTolerance tolerance_;
  Work work_;
  State state_;
  double previous_time_ = 0;
  std::vector<double> previous_;
  Eigen::ArrayXd slope_;
  StepStatistics statistics_;
  double latest_ = std::numeric_limits<double>::infinity();  ///< last time at which the step may evaluate
  int sign_ = 1;
  Evaluation failed_;     ///< the last evaluation that failed in this step
  long failures_ = 0;     ///< of CVODE's, those counted
  bool begin_ = true;     ///< CVODE begins anew at state_
  CvodeHistory history_;  ///< since CVODE last began
  Context context_;
  Vector y_, inside_;
  Matrix matrix_;
  LinearSolver solver_;
  CvodeMemory cvode_;
};

class Cvode final : public Integrator {
 public:
  explicit Cvode(const CvodeOptions& options) : options_(options) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr)
      refuse_loops("cvode", "it goes on from a history of steps, which are not those of states that have been closed");
    return std::make_unique<CvodeStepper>(equations, state, options_);
  }
  /// The highest: the method chooses.
  int order() const override { return options_.stiff ? 5 : 12; }

 private:
  CvodeOptions options_;
};

std::unique_ptr<Integrator> make(const Value& p, const MakeContext& context) {
  const std::optional<StepControl> control = read_step_control(p, context);
  if (!control) return nullptr;
  return std::make_unique<Cvode>(CvodeOptions{*control, p.at("method").text() == "bdf", jacobian_source(p)});
}

std::vector<ParameterSpec> parameters() {
  std::vector<ParameterSpec> all = step_control_parameters();
  all.push_back(text("method", "backward differentiation, for what is stiff, or Adams-Moulton")
                    .one_of({"bdf", "adams"})
                    .otherwise("bdf"));
  all.push_back(jacobian_parameter());
  return all;
}

void enroll(Enrollment& enrollment) {
  enrollment.add<Integrator>(
      {.id = "cvode",
       .summary = "SUNDIALS CVODE: multistep methods of variable order, stiff or not, tolerance calibrated",
       .parameters = parameters(),
       .make = &make});
}

}  // namespace
}  // namespace withy

WITHY_PLUGIN(cvode, withy::enroll);
