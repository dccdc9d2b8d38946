/// \file
/// The error of a run against equations that neglect less.
#pragma once

#include <optional>
#include <set>
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
  std::string against;          ///< formulation
  NamedDistances distances;     ///< `until` is less than `end` where the evaluations allowed were spent
  double end = 0;               ///< time the run reached [s]
  std::size_t evaluations = 0;  ///< of both models
  double cpu_seconds = 0;
  /// Of the equations of the run along the coarse one. What a hundred times the tolerance does not change is no error
  /// of the integration but what the formulation leaves out.
  Drifts drifts = {};
  /// Names of outputs whose error is too small for the coarse runs to tell: it is roughly no more than the distance, of
  /// what they differ by and of what they are off the run.
  std::set<std::string> at_most = {};
  /// The greatest part of an output's range that the coarse run is off the run itself; zero of an estimate at any
  /// price, whose runs are as exact as it asks.
  double off = 0;
  std::string lacks = {};  ///< what the other model neglects, where that may be as much as it tells; else empty
};

/// What an estimate may cost.
enum class Price {
  tenth,  ///< of the run, by counts of evaluations and what they were measured to take: the same on every machine
  any     ///< as many evaluations of the pair as the run had of its own, at tolerances that resolve its motion; where
          ///< these end elsewhere than the run, three times as many at a hundredth of them, and where those do too
          ///< nothing is estimated: the motion is sensitive
};

/// An estimate, or why there is none.
struct EstimateOutcome {
  std::optional<ErrorEstimate> estimate;
  std::string why_not;  ///< empty where there is one
};

/// Estimates it for the time that the run went. At a tenth of its cost both models take the steps that it pays for,
/// stiffness and damping implicit (CoarseSteps), or where these do not come to the run's own end, those of radau at
/// a low tolerance: what comes to another end tells nothing of the run, and what leaves it on the way little.
/// \param used the equations of the run, from its start to its end
/// \param summary of a run that looked beyond: of strict equations the states that it kept closely are needed
/// \throws InputError where there is no integrator dopri5; std::invalid_argument where a load has switching functions.
EstimateOutcome estimate_error(const Scene& scene, const EquationsOfMotion& used, const Beyond& beyond,
                               const RunSummary& summary, Registry& registry, Price price,
                               const std::function<bool()>& interrupted);

}  // namespace withy::study
