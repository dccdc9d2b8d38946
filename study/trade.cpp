#include "withy/study/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "withy/core/simulation/integrator_call.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/check_loads.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/step_limit.hpp"
#include "withy/study/tip_load.hpp"
#include "withy/study/work_together.hpp"

namespace withy::study {
namespace {

/// The values gone over, as references are known by.
std::string key_of(const std::vector<std::string>& over) { return fmt::format("{}", fmt::join(over, " ")); }

/// A run with the least CPU time it was seen to take.
struct TimedRun {
  RunSummary summary;
  Readings readings;
  double cpu_seconds = std::numeric_limits<double>::max();
};

/// Short runs are timed again and again: the least time is nearest to what the processor needs.
TimedRun timed_run(const Prepared& model, const Outputs& outputs, const Control& control) try {
  constexpr int most_runs = 30;
  constexpr double long_enough = 0.05;  // s
  RunOptions options = run_options(model.scene);
  options.events.clear();
  // As the reference: a model that meets an event early would be measured, and cost, up to there alone.
  options.past_stops = true;
  options.interrupted = control.interrupted;
  watch_poles(model, options);
  TimedRun run;
  std::vector<State> states;
  double spent = 0;
  for (int i = 0; i < most_runs && spent < long_enough; ++i) {
    states.clear();
    run.summary = withy::simulate(model.model(), *model.equations, *model.scene.integrator, model.scene.initial,
                                  options, [&](const State& s) { states.push_back(s); });
    run.cpu_seconds = std::min(run.cpu_seconds, run.summary.cpu_seconds);
    spent += run.summary.cpu_seconds;
  }
  OutputReader reader(outputs, model.model(), *model.equations, model.scene.outputs);
  for (const State& s : states) {
    run.readings.times.push_back(s.time);
    run.readings.values.push_back(reader.read(s));
  }
  return run;
} catch (const IntegratorError& e) {
  throw e.named(model.scene.integrator_name);
}

}  // namespace

/// A reference with the readings that runs are measured against.
struct TradeStudy::Known {
  Reference reference;
  double relative_error = 0;
};

/// What threads share while they work.
struct TradeStudy::Pool {
  std::vector<std::size_t> open;  ///< points that are not finished
  std::atomic<std::size_t> next{0};
  std::mutex mutex;  ///< for all that follows, results and the store
  std::size_t done = 0;
  std::exception_ptr failure;
};

TradeStudy::TradeStudy(const Prepared& base, Registry& registry, std::vector<Point> points, TradeOptions options)
    : base_(base),
      registry_(registry),
      points_(std::move(points)),
      options_(std::move(options)),
      outputs_(base.model(), options_.outputs, base.scene.outputs),
      finished_(points_.size()) {
  check_loads(base);
  for (std::size_t i = 0; i < points_.size(); ++i) look_up(i);
}

TradeStudy::~TradeStudy() = default;

void TradeStudy::add(const Point& point) {
  points_.push_back(point);
  finished_.emplace_back();
  look_up(points_.size() - 1);
}

void TradeStudy::look_up(std::size_t index) {
  if (options_.store == nullptr) return;
  const auto kept = options_.store->find(points_[index]);
  if (!kept) return;
  finished_[index] = kept->result;
  told_[key_of(points_[index].over)] = kept->reference;
}

void TradeStudy::find_reference_for(const Point& point) {
  const std::string key = key_of(point.over);
  if (known_.contains(key)) return;
  if (point.over.empty()) require_a_run(base_.scene);
  ReferenceGoal goal;
  // Of all that mean the same, whatever families are compared.
  ReferenceFamilies families = reference_families(candidates_for(base_, registry_, usual_axes()), base_);
  goal.families = std::move(families.others);
  // Static shapes do not depend on what the scene says of bodies at tips, which may be gone over.
  std::erase(goal.families, loaded_modes);
  if (!point.over.empty()) std::erase(goal.families, vibration_modes);
  goal.first = {"", std::move(families.first), 0, "dop853", 1e-6, point.over};
  for (const Point& p : points_) {
    goal.first.modes = std::max(goal.first.modes, p.modes);
    goal.first.tolerance = std::min(goal.first.tolerance, p.tolerance);
  }
  // The first two of a complete basis tell little of what more will change.
  if (goal.first.modes > 0 && !goal.first.family.empty()) goal.first.modes = std::max(goal.first.modes, 3);
  goal.tightest = 0.1 * goal.first.tolerance;
  goal.levels = goal.kinds = kinds_of_modes(base_.scene);
  if (goal.kinds == 1 && goal.first.modes > 2) {
    // A level before tells where the series of modes leads to.
    const int finest = goal.first.modes + 1;
    --goal.first.modes;
    goal.levels = 2;
    goal.enough = [finest](const Reference& r) { return r.point.modes >= finest; };
  }
  std::vector<std::unique_ptr<ModelAt>> models;
  const auto model = [&](const Point& p) -> const ModelAt& {
    models.push_back(std::make_unique<ModelAt>(model_at(base_, registry_, p)));
    return *models.back();
  };
  ReferenceFound found = find_reference(model, registry_, outputs_, goal, options_.control);
  if (found.interrupted) return;
  if (!found.reference) throw InputError("no reference to measure against: " + found.trouble);
  const Reference& r = *found.reference;
  const double relative = relative_error(r.own, r.scales);
  const NamedDistances ways = named(outputs_, r.ranges, 0), own = named(outputs_, r.own, 0);
  told_[key] = {r.point,  ways.greatest_hinge(), ways.greatest_tip(), own.greatest_hinge(), own.greatest_tip(),
                relative, ways.sensors,          own.sensors};
  known_.emplace(key, Known{std::move(*found.reference), relative});
}

TradeResult TradeStudy::run_point(const Point& point) const {
  TradeResult result;
  result.point = point;
  const auto refused = [&](const std::exception& e) {
    result.status = "refused";
    result.message = e.what();
  };
  try {
    const Prepared model = prepare(values_at(base_.values, base_.scene, point, registry_), registry_);
    const TimedRun run = timed_run(model, outputs_, options_.control);
    result.status = name(run.summary.status);
    result.message = run.summary.message;
    result.steps = run.summary.steps.accepted;
    result.evaluations = run.summary.steps.evaluations;
    result.cpu_seconds = run.cpu_seconds;
    const Known& known = known_.at(key_of(point.over));
    const auto [distance, until] = distances(outputs_, run.readings, known.reference.readings);
    const NamedDistances by_name = named(outputs_, distance, until);
    result.hinge_error = by_name.greatest_hinge();
    result.tip_error = by_name.greatest_tip();
    result.sensors = by_name.sensors;
    result.relative_error = relative_error(distance, known.reference.scales);
    result.reference_error = known.relative_error;
  } catch (const SceneError& e) {
    refused(e);
  } catch (const InputError& e) {
    refused(e);
  } catch (const std::invalid_argument& e) {
    refused(e);
  }
  return result;
}

void TradeStudy::work(Pool& pool) {
  for (std::size_t k = pool.next++; k < pool.open.size() && !options_.control.stop(); k = pool.next++) {
    try {
      const Point& point = points_[pool.open[k]];
      const TradeResult result = run_point(point);
      if (result.status == name(RunStatus::interrupted)) return;
      const std::lock_guard lock(pool.mutex);
      if (options_.store != nullptr) options_.store->keep({result, told_.at(key_of(point.over))});
      finished_[pool.open[k]] = result;
      ++pool.done;
      options_.control.tell(static_cast<double>(points_.size() - pool.open.size() + pool.done),
                            static_cast<double>(points_.size()));
    } catch (...) {
      const std::lock_guard lock(pool.mutex);
      pool.failure = std::current_exception();
      pool.next = pool.open.size();
    }
  }
}

bool TradeStudy::run() {
  Pool pool;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (!finished_[i]) pool.open.push_back(i);
  // References first: threads then only read them.
  for (const std::size_t i : pool.open) {
    if (options_.control.stop()) return false;
    find_reference_for(points_[i]);
  }
  if (options_.control.stop()) return false;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t most = std::max<std::size_t>(pool.open.size(), 1);
  const std::size_t jobs = std::min(options_.jobs > 0 ? options_.jobs : cores, most);
  work_together(jobs, [&](std::size_t) { work(pool); });
  if (pool.failure) std::rethrow_exception(pool.failure);
  return !options_.control.stop();
}

const TradeResult* TradeStudy::result(const Point& point) const {
  const std::string key = point.key();
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (finished_[i] && points_[i].key() == key) return &*finished_[i];
  return nullptr;
}

std::vector<TradeResult> TradeStudy::results() const {
  std::vector<TradeResult> all;
  for (const auto& r : finished_)
    if (r) all.push_back(*r);
  return all;
}

std::vector<bool> pareto_front(const std::vector<TradeResult>& results) {
  const auto error = [](const TradeResult& r) { return std::max(r.relative_error, r.reference_error); };
  std::vector<bool> front(results.size(), false);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const TradeResult& a = results[i];
    front[i] = a.completed() && std::none_of(results.begin(), results.end(), [&](const TradeResult& b) {
                 return b.completed() && b.point.over == a.point.over && error(b) <= error(a) &&
                        b.cpu_seconds <= a.cpu_seconds && (error(b) < error(a) || b.cpu_seconds < a.cpu_seconds);
               });
  }
  return front;
}

}  // namespace withy::study
