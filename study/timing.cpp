#include "withy/study/timing.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <vector>

#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

EvaluationTimes time_evaluations(const EquationsOfMotion& equations, const State& state,
                                 const std::function<std::size_t()>& allocations) {
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  Evaluation outcome;
  const auto time = [&](std::size_t count) {
    const double begin = cpu_seconds();
    for (std::size_t i = 0; i < count; ++i) outcome = equations.derivatives(state.time, state.y, rates, work);
    return cpu_seconds() - begin;
  };
  // The first batches warm caches and clock rate.
  std::size_t batch = 1;
  while (time(batch) < 0.01) batch *= 2;
  if (!outcome.ok()) throw InputError("the equations of motion cannot be evaluated at this state; see withy eval");
  std::array<double, 25> times{};
  const std::size_t before = allocations ? allocations() : 0;
  for (double& t : times) t = time(batch);
  EvaluationTimes result;
  result.evaluations = batch * times.size();
  if (allocations)
    result.allocations = static_cast<double>(allocations() - before) / static_cast<double>(result.evaluations);
  std::sort(times.begin(), times.end());
  const auto count = static_cast<double>(batch);
  result.median = times[times.size() / 2] / count;
  result.fastest = times.front() / count;
  result.slowest = times.back() / count;
  return result;
}

}  // namespace withy::study
