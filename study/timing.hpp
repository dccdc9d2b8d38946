/// \file
/// What an evaluation of the equations of motion costs.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/state.hpp"

namespace withy::study {

/// CPU times of one evaluation [s]: batches of at least ten milliseconds, long against the clock's resolution.
struct EvaluationTimes {
  double median = 0, fastest = 0, slowest = 0;  ///< of the batches
  std::size_t evaluations = 0;                  ///< that were timed
  double allocations = 0;                       ///< an evaluation, by the counter
};

/// Evaluates one state again and again, warm.
/// \param allocations of the process so far; may be empty
/// \throws InputError where the equations cannot be evaluated at the state.
EvaluationTimes time_evaluations(const EquationsOfMotion& equations, const State& state,
                                 const std::function<std::size_t()>& allocations);

struct LaneTimes {
  std::string refusal;  ///< why these equations have no lanes, and no times; empty where they have
  EvaluationTimes times;
};

/// The same, a case in each lane at once: times of one evaluation of one case.
/// \throws InputError where the equations cannot be evaluated at the state.
LaneTimes time_lanes(const EquationsOfMotion& equations, const State& state,
                     const std::function<std::size_t()>& allocations);

/// What threads make of one evaluation.
struct ThreadTimes {
  std::string refusal;    ///< why the branches are not evaluated on threads, and no times; empty where they are
  std::size_t count = 0;  ///< of threads
  double one = 0;         ///< wall time of an evaluation on one thread [s]: the fastest batch of several, in turns with
  double several = 0;     ///< that on all of them
  double hand_over = 0;   ///< wall time that an evaluation spends on handing over [s]
  double share = 1;       ///< of the sweeps that one thread has at most, as BranchEquations
  double pays_from = 0;   ///< what an evaluation of such a tree takes on one thread where both take as long [s]
};

/// Evaluates one state again and again, on one thread and with the branches of the tree on several.
/// \throws InputError where the equations cannot be evaluated at the state.
ThreadTimes time_threads(const std::shared_ptr<const EquationsOfMotion>& equations, const State& state,
                         std::size_t threads);

/// The formulations that a name is enough for, but `auto`: its equations are others', chosen along a run.
std::vector<std::string> timed_formulations(Registry& registry);

}  // namespace withy::study
