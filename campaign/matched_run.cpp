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
#include "withy/core/simulation/stepping.hpp"
#include "withy/core/simulation/stop.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/study/work_together.hpp"

namespace withy::campaign {
namespace {

/// Reads the results at the times of the data as they are passed.
class MatchingObserver final : public SteppingObserver {
 public:
  MatchingObserver(const study::Prepared& prepared, const Measured& data, const study::Control& control)
      : data_(data),
        control_(control),
        results_(prepared.model(), *prepared.equations, prepared.scene.outputs),
        sample_(prepared.scene.initial) {
    run.columns.resize(data.columns.size());
    for (std::vector<double>& column : run.columns) column.reserve(data.times.size());
  }

  /// Results at the start. \param sign of the mass matrix's determinant there
  void begin(const State& state, int sign) {
    sign_ = sign;
    constexpr double rounding = 1e-9;
    while (due(state.time + rounding * (1 + std::abs(state.time)))) read(state);
  }
  bool before_step(const Stepper&) override {
    run.interrupted = control_.stop();
    return !run.interrupted;
  }
  bool output(const State&) override { return true; }
  bool after_step(const Stepper& stepper, bool) override {
    if (stepper.statistics().determinant_sign != sign_)
      return fail(stepper.state().time, "the determinant of the mass matrix changed its sign");
    while (due(stepper.state().time)) {
      sample_ = stepper.state();
      sample_.time = data_.times[next_];
      interpolate_step(stepper, sample_.time, sample_.y);
      if (!read(sample_)) return false;
    }
    return true;
  }
  /// What is known when stepping has ended: the data has to be covered.
  void finish(const State& state, const std::string& why) {
    if (run.ok() && next_ < data_.times.size()) fail(state.time, why);
  }

  MatchedRun run;

 private:
  [[nodiscard]] bool due(double t) const { return next_ < data_.times.size() && data_.times[next_] <= t; }
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

  const Measured& data_;
  const study::Control& control_;
  ResultColumns results_;
  State sample_;
  std::size_t next_ = 0;  ///< of the data's times
  int sign_ = 1;
};

MatchedRun run_steps(const study::Prepared& prepared, const Measured& data, const study::Control& control) {
  const Scene& scene = prepared.scene;
  const EquationsOfMotion& equations = *prepared.equations;
  const State start = begun(*scene.model, equations, scene.initial);
  const double end = std::max(data.times.back(), start.time);
  EventActions actions(*scene.model, equations, scene.events);
  Stepping loop(*scene.model, equations, start_stepper(*scene.integrator, equations, start),
                {.end = end, .output = scene.output, .events = actions.watched(), .actions = &actions});
  MatchingObserver observer(prepared, data, control);
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  observer.begin(start, equations.derivatives(start.time, start.y, rates, work).determinant_sign);
  const SteppingEnd ended = loop.run(observer);
  std::string why;
  if (ended.cause == SteppingEnd::Cause::event) why = "an event of the scene ends it there";
  if (ended.cause == SteppingEnd::Cause::failed || ended.cause == SteppingEnd::Cause::crowded)
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
