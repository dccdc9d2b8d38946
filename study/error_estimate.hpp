/// \file
/// The error of a run against equations that neglect less.
#pragma once

#include <string>
#include <vector>

#include "withy/study/measures.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// How far energy and momenta went from their balance, over the scales of the run's summary.
struct Drifts {
  double energy = 0, linear = 0, angular = 0;
};

/// The error of a run's hinges and tips against the next model up, by integrating both coarsely with common steps.
struct ErrorEstimate {
  std::string against;       ///< formulation
  NamedDistances distances;  ///< `until` is less than `end` where the evaluations allowed were spent
  double end = 0;            ///< time the run reached [s]
  double cpu_seconds = 0;
  /// Of the equations of the run along the coarse one. What a hundred times the tolerance does not change is no error
  /// of the integration but what the formulation leaves out.
  Drifts drifts = {};
  std::vector<State> along = {};  ///< a dozen of its states in these equations
};

/// Estimates it for the time that the run went, with no more evaluations of the pair than the run had of its own.
/// \param used the equations of the run, from its start to its end
/// \throws InputError where there is no integrator dopri5; std::invalid_argument where a load has switching functions.
ErrorEstimate estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                             const RunSummary& summary, Registry& registry, const std::function<bool()>& interrupted);

}  // namespace withy::study
