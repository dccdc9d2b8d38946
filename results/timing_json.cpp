#include "withy/results/timing_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/core/equations/lane_equations.hpp"

namespace withy {

nlohmann::ordered_json times_json(const study::EvaluationTimes& times) {
  return {{"ns_per_evaluation", 1e9 * times.median},
          {"ns_fastest_batch", 1e9 * times.fastest},
          {"ns_slowest_batch", 1e9 * times.slowest},
          {"evaluations", times.evaluations},
          {"allocations_per_evaluation", times.allocations}};
}

nlohmann::ordered_json lanes_json(const study::LaneTimes& lanes, const study::EvaluationTimes& one) {
  nlohmann::ordered_json result{{"evaluations_per_second", 1 / one.median}};
  if (!lanes.refusal.empty()) {
    result["one_at_a_time_because"] = lanes.refusal;
    return result;
  }
  result["at_once"] = lane_count();
  result["evaluations_per_second_in_lanes"] = 1 / lanes.times.median;
  result["ratio"] = one.median / lanes.times.median;
  result.update(times_json(lanes.times));
  return result;
}

nlohmann::ordered_json threads_json(const study::ThreadTimes& threads, std::size_t bodies) {
  nlohmann::ordered_json result{{"count", threads.count}};
  if (!threads.refusal.empty()) {
    result["one_thread_because"] = threads.refusal;
    return result;
  }
  result["ns_one_thread"] = 1e9 * threads.one;
  result["ns_all_threads"] = 1e9 * threads.several;
  result["ratio"] = threads.one / threads.several;
  result["longest_share"] = threads.share;
  result["ns_hand_over"] = 1e9 * threads.hand_over;
  result["pays_from_ns"] = 1e9 * threads.pays_from;
  result["pays_from_bodies"] = std::ceil(static_cast<double>(bodies) * threads.pays_from / threads.one);
  return result;
}

}  // namespace withy
