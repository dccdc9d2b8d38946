#include "withy/campaign/matched_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <stdexcept>

#include "withy/core/simulation/event_actions.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/core/simulation/same_instant.hpp"
#include "withy/core/simulation/stepping.hpp"
#include "withy/core/simulation/stop.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/study/work_together.hpp"

namespace withy::campaign {
namespace {

/// Where a run ends [s]: with the scene, as that of `withy run`, whose steps it makes; with the data where the scene
/// has no end, or a parameter has moved it before them.
double end_of_matched(const Scene& scene, const Measured& data, double start) {
  const double last = data.times.back();
  const bool covered = scene.end && last <= *scene.end + leeway(last);
  return std::max(covered ? *scene.end : last, start);
}

/// Reads the results at the times of the data, as the rows of a run at these times show them.
class MatchingObserver final : public SteppingObserver {
 public:
  MatchingObserver(const study::Prepared& prepared, const Measured& data, const study::Control& control, double end)
      : data_(data),
        control_(control),
        results_(prepared.model(), *prepared.equations, prepared.scene.outputs),
        jumps_(discontinuities(prepared.model())),
        end_(end),
        sample_(prepared.scene.initial) {
    run.columns.resize(data.columns.size());
    for (std::vector<double>& column : run.columns) column.reserve(data.times.size());
    while (inside_ > 0 && comes_by(end, data.times[inside_ - 1])) --inside_;
  }

  /// Results at the start. \param sign of the mass matrix's determinant there
  void begin(const State& state, int sign) {
    sign_ = sign;
    shown_ = state.time;
    while (due(state.time) && read(state)) continue;
  }
  bool before_step(const Stepper&) override {
    run.interrupted = control_.stop();
    return run.ok() && next_ < data_.times.size();
  }
  bool output(const State& state) override {
    shown_ = state.time;
    return true;
  }
  bool after_step(const Stepper& stepper, bool) override {
    if (stepper.statistics().determinant_sign != sign_)
      return fail(stepper.state().time, "the determinant of the mass matrix changed its sign");
    while (due(stepper.state().time)) {
      sample_ = stepper.state();
      interpolate_step(stepper, data_.times[next_], sample_.y);
      sample_.time = from_jump_on(jumps_, data_.times[next_]);
      if (!read(sample_)) return false;
    }
    return true;
  }
  /// The run has ended, at its end or at an event: its last row is the state from then on, unless an event has come at
  /// the time of a row.
  void show_last(const State& state) {
    if (!run.ok()) return;
    const auto to_show = [&](double time) { return time > shown_ && same_instant(time, state.time); };
    while (next_ > 0 && to_show(data_.times[next_ - 1])) take_back();
    const bool whole = state.time >= end_;
    while (next_ < data_.times.size() && (whole || comes_by(data_.times[next_], state.time)) && read(state)) continue;
  }
  /// What is known when stepping has ended: the data has to be covered.
  void finish(const State& state, const std::string& why) {
    if (run.ok() && next_ < data_.times.size()) fail(state.time, why);
  }

  MatchedRun run;

 private:
  /// Whether a time is at another or before it. One that is later by rounding alone is at it, as an output is.
  static bool comes_by(double time, double other) { return time <= other || same_instant(time, other); }
  [[nodiscard]] bool due(double t) const { return next_ < inside_ && comes_by(data_.times[next_], t); }
  bool fail(double t, const std::string& why) {
    run.failure = fmt::format("it stopped at t = {:.4g} s: {}", t, why);
    return false;
  }
  bool read(const State& state) {
    const std::vector<double>& row = results_.row(state);
    for (std::size_t c = 0; c < data_.columns.size(); ++c) {
      const double x = row[data_.columns[c].result];
      if (!std::isfinite(x)) return fail(state.time, data_.columns[c].name + " is not finite");
      run.columns[c].push_back(x);
    }
    ++next_;
    return true;
  }
  void take_back() {
    for (std::vector<double>& column : run.columns) column.pop_back();
    --next_;
  }

  const Measured& data_;
  const study::Control& control_;
  ResultColumns results_;
  std::vector<double> jumps_;  ///< times [s] at which loads or motions jump, increasing
  double end_;                 ///< [s]
  State sample_;
  std::size_t inside_ = data_.times.size();  ///< of the data's times so many lie before the run's end
  std::size_t next_ = 0;                     ///< of the data's times
  double shown_ = 0;                         ///< time [s] of the last row that the run itself shows
  int sign_ = 1;
};

MatchedRun run_steps(const study::Prepared& prepared, const Measured& data, const study::Control& control) {
  const Scene& scene = prepared.scene;
  const EquationsOfMotion& equations = *prepared.equations;
  const State start = begun(*scene.model, equations, scene.initial);
  const double end = end_of_matched(scene, data, start.time);
  EventActions actions(*scene.model, equations, scene.events);
  Stepping loop(*scene.model, equations, start_stepper(*scene.integrator, equations, start),
                {.end = end, .output = scene.output, .events = actions.watched(), .actions = &actions});
  MatchingObserver observer(prepared, data, control, end);
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  observer.begin(start, equations.derivatives(start.time, start.y, rates, work).determinant_sign);
  const SteppingEnd ended = loop.run(observer);
  using Cause = SteppingEnd::Cause;
  if (ended.cause == Cause::reached || ended.cause == Cause::event) observer.show_last(loop.state());
  std::string why;
  if (ended.cause == Cause::event) why = "an event of the scene ends it there";
  if (ended.cause == Cause::failed || ended.cause == Cause::crowded || ended.cause == Cause::unknown_inside)
    why = stop_of(ended, *scene.model, equations, loop.state(), loop.stepper()).reason;
  observer.finish(loop.state(), why);
  return std::move(observer.run);
}

MatchedRun run_prepared(const study::Prepared& prepared, const Measured& data, const study::Control& control) {
  try {
    return run_steps(prepared, data, control);
  } catch (const IntegratorError& e) {
    throw e.named(prepared.scene.integrator_name);
  }
}

}  // namespace

MatchedRun matched_run(const SceneValues& scene, Registry& registry, const Measured& data,
                       const study::Control& control) {
  const auto failed = [](const std::exception& e) { return MatchedRun{{}, e.what(), false}; };
  try {
    return run_prepared(study::prepare(scene, registry), data, control);
  } catch (const SceneError& e) {
    return failed(e);
  } catch (const study::InputError& e) {
    return failed(e);
  } catch (const std::invalid_argument& e) {
    return failed(e);
  }
}

std::vector<MatchedRun> matched_runs(const std::vector<SceneValues>& scenes, Registry& registry, const Measured& data,
                                     std::size_t jobs, const study::Control& control) {
  std::vector<MatchedRun> runs(scenes.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&](std::size_t) {
    for (std::size_t k = next++; k < scenes.size(); k = next++) {
      try {
        runs[k] = matched_run(scenes[k], registry, data, control);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        next = scenes.size();
      }
    }
  };
  study::work_together(std::min(jobs, scenes.size()), work);
  if (failure) std::rethrow_exception(failure);
  return runs;
}

}  // namespace withy::campaign
