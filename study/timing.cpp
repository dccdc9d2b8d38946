#include "withy/study/timing.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <vector>

#include "withy/core/equations/branch_equations.hpp"
#include "withy/core/equations/lane_equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// Times of `evaluate`, which makes `each` evaluations and returns whether they could be made.
template <class Evaluate>
EvaluationTimes time_calls(std::size_t each, const std::function<std::size_t()>& allocations, Evaluate&& evaluate) {
  bool good = true;
  const auto time = [&](std::size_t count) {
    const double begin = thread_cpu_seconds();
    for (std::size_t i = 0; i < count; ++i) good = evaluate();
    return thread_cpu_seconds() - begin;
  };
  // The first batches warm caches and clock rate.
  std::size_t batch = 1;
  while (time(batch) < 0.01) batch *= 2;
  if (!good) throw InputError("the equations of motion cannot be evaluated at this state; see withy eval");
  std::array<double, 25> times{};
  const std::size_t before = allocations ? allocations() : 0;
  for (double& t : times) t = time(batch);
  EvaluationTimes result;
  result.evaluations = batch * times.size() * each;
  if (allocations)
    result.allocations = static_cast<double>(allocations() - before) / static_cast<double>(result.evaluations);
  std::sort(times.begin(), times.end());
  const auto count = static_cast<double>(batch * each);
  result.median = times[times.size() / 2] / count;
  result.fastest = times.front() / count;
  result.slowest = times.back() / count;
  return result;
}

}  // namespace

EvaluationTimes time_evaluations(const EquationsOfMotion& equations, const State& state,
                                 const std::function<std::size_t()>& allocations) {
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  return time_calls(1, allocations, [&] { return equations.derivatives(state.time, state.y, rates, work).ok(); });
}

LaneTimes time_lanes(const EquationsOfMotion& equations, const State& state,
                     const std::function<std::size_t()>& allocations) {
  const std::unique_ptr<LaneEquations> lanes = lane_equations(equations);
  if (lanes == nullptr) return {lane_refusal(equations), {}};
  std::vector<std::vector<double>> rates(lane_count());
  std::vector<Work> work;
  std::vector<LaneCall> calls(lane_count());
  std::vector<LaneCall*> asked(lane_count());
  work.reserve(calls.size());
  for (std::size_t lane = 0; lane < calls.size(); ++lane) {
    rates[lane].resize(equations.size());
    work.push_back(equations.make_work());
    calls[lane] = {state.time, state.y, rates[lane], &work.back(), {}};
    asked[lane] = &calls[lane];
  }
  const auto evaluate = [&] {
    lanes->derivatives(asked);
    return calls.front().evaluation.ok();
  };
  return {{}, time_calls(calls.size(), allocations, evaluate)};
}

ThreadTimes time_threads(const std::shared_ptr<const EquationsOfMotion>& equations, const State& state,
                         std::size_t threads) {
  ThreadTimes times;
  times.count = threads;
  const BranchEquations branched = on_threads(equations, threads);
  times.refusal = branched.refusal;
  if (branched.equations == nullptr) return times;
  using Clock = std::chrono::steady_clock;
  const auto batch = [&](const EquationsOfMotion& of) {
    constexpr auto enough = std::chrono::milliseconds(1);
    std::vector<double> rates(of.size());
    Work work = of.make_work();
    std::size_t made = 0;
    const Clock::time_point began = Clock::now();
    Clock::duration taken{};
    for (; taken < enough; taken = Clock::now() - began, ++made)
      if (!of.derivatives(state.time, state.y, rates, work).ok())
        throw InputError("the equations of motion cannot be evaluated at this state; see withy eval");
    return std::chrono::duration<double>(taken).count() / static_cast<double>(made);
  };
  times.one = times.several = std::numeric_limits<double>::infinity();
  constexpr int turns = 200;
  for (int turn = 0; turn < turns; ++turn) {
    times.one = std::min(times.one, batch(*equations));
    times.several = std::min(times.several, batch(*branched.equations));
  }
  times.hand_over = hand_over_seconds(threads);
  times.share = branched.share;
  times.pays_from = times.hand_over / (1 - times.share);
  return times;
}

std::vector<std::string> timed_formulations(Registry& registry) {
  std::vector<std::string> ids = registry.ids<Formulation>();
  std::erase_if(ids, [&](const std::string& id) {
    const std::vector<ParameterSpec>& options = registry.find<Formulation>(id)->parameters;
    return id == "auto" || std::any_of(options.begin(), options.end(), [](const auto& o) { return o.required; });
  });
  return ids;
}

}  // namespace withy::study
