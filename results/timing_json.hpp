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
/// What threads make of an evaluation, and the size of a tree of this kind, in bodies, from which they pay; or why
/// there is no such thing. \param bodies of this tree
nlohmann::ordered_json threads_json(const study::ThreadTimes& threads, std::size_t bodies);

}  // namespace withy
