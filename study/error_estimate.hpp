/// \file
/// The error of a run against equations that neglect less.
#pragma once

#include <string>

#include "withy/study/measures.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// The error of a run's hinges and tips against the next model up, by integrating both coarsely with common steps.
struct ErrorEstimate {
  std::string against;       ///< formulation
  NamedDistances distances;  ///< `until` is less than `end` where the evaluations allowed were spent
  double end = 0;            ///< time the run reached [s]
  double cpu_seconds = 0;
};

/// Estimates it for the time that the run went, with no more evaluations of the pair than the run had of its own.
/// \param used the equations of the run, from its start to its end
/// \throws InputError where there is no integrator dopri5; std::invalid_argument where a load has switching functions.
ErrorEstimate estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                             const RunSummary& summary, Registry& registry, const std::function<bool()>& interrupted);

}  // namespace withy::study
