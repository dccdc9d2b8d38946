#include "withy/study/search_time.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "withy/core/simulation/run_times.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {
namespace {

/// CPU time of one evaluation at the initial state [s]: the least of some batches, since other work only adds; of fewer
/// evaluations each where these take long.
double least_seconds_per_evaluation(const Prepared& model) {
  const EquationsOfMotion& equations = *model.equations;
  const State& initial = model.scene.initial;
  Work work = equations.make_work();
  std::vector<double> rates(equations.size());
  double least = std::numeric_limits<double>::max();
  constexpr int first = 4, most = 40;
  constexpr double batch_seconds = 1e-3;
  for (int batch = 0, count = first; batch < 5; ++batch) {
    if (batch > 0) count = std::clamp(static_cast<int>(batch_seconds / least), 1, most);
    const double began = thread_cpu_seconds();
    for (int i = 0; i < count; ++i) static_cast<void>(equations.derivatives(initial.time, initial.y, rates, work));
    least = std::min(least, (thread_cpu_seconds() - began) / count);
  }
  return least;
}

class ProcessorTime final : public SearchTime {
 public:
  [[nodiscard]] double now() const override { return thread_cpu_seconds(); }
  [[nodiscard]] double of_evaluation(const Prepared& model) const override {
    return least_seconds_per_evaluation(model);
  }
  void evaluated(const Prepared& /*model*/, std::size_t /*count*/) override {}  // it has gone by meanwhile
};

SearchTime*& time_in_place() {
  static ProcessorTime processor;
  thread_local SearchTime* time = &processor;
  return time;
}

}  // namespace

SearchTime& search_time() { return *time_in_place(); }

SearchTimeInPlace::SearchTimeInPlace(SearchTime& time) : before_(time_in_place()) { time_in_place() = &time; }

SearchTimeInPlace::~SearchTimeInPlace() { time_in_place() = before_; }

}  // namespace withy::study
