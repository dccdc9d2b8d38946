/// \file
/// What evaluations of the equations of motion cost, as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "withy/study/timing.hpp"

namespace withy {

/// Nanoseconds of the median, fastest and slowest batch, evaluations timed, allocations of each.
nlohmann::ordered_json times_json(const study::EvaluationTimes& times);
/// What as many cases at once as there are lanes cost beside one at a time, `one`; or why there is no such thing.
nlohmann::ordered_json lanes_json(const study::LaneTimes& lanes, const study::EvaluationTimes& one);

}  // namespace withy
