/// \file
/// How far a run is from one with more modes: what an error against another formulation does not contain.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "withy/study/measures.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// What one mode more of every family of every body changes in a run. The series of modes goes on from there: it is no
/// bound of the error, and where it shrinks slowly the error is several times as great.
struct MoreModes {
  NamedDistances distances;     ///< greatest at 500 times, or of these at those that both have, up to `until`
  double end = 0;               ///< time the run reached [s]
  std::size_t evaluations = 0;  ///< of both
  double cpu_seconds = 0;
};

/// That, or why it is not known.
struct MoreModesOutcome {
  std::optional<MoreModes> more;
  std::string why_not;  ///< in a sentence; empty where it is known, and where no body has a number of modes
};

/// Whether a body has a number of modes, that can be greater by one.
bool can_be_refined(const Scene& scene);

/// Runs the scene as it is and with one mode more of each, with the scene's own integrator, and compares them at 500
/// times, whatever outputs the scene has: the cost of the run and somewhat more than that. Modes that are new begin at
/// rest. \param until what the run is compared up to [s] \throws PluginError
MoreModesOutcome with_one_mode_more(const Prepared& prepared, Registry& registry, double until,
                                    const std::function<bool()>& interrupted);

}  // namespace withy::study
