/// \file
/// The run that errors are measured against, and how well it is known: the one search of every study.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/control.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {

/// What errors are measured against, richest first: the rungs of `auto` that truncate nothing. The first that every
/// body of a scene can be in is taken.
std::vector<std::string> reference_formulations(Registry& registry);

/// A run whose outputs are the truth, and how true they are.
struct Reference {
  Point point;
  Readings readings;
  Distances ranges;   ///< greatest distances of outputs from their start
  double energy = 0;  ///< greatest kinetic energy at an output [J]
  Distances scales;   ///< what relative errors are shares of
  Distances own;      ///< from the run with one mode less and the tolerance before; empty: not known
  Walk walk;
};

/// Where a search begins and when it ends.
struct ReferenceGoal {
  Point first;  ///< the coarsest; its formulation means nothing
  /// Finer ones that are looked at: a mode more where the first has any, the tolerance times `finer` down to
  /// `tightest`.
  int levels = 1;
  double finer = 0.1;
  double tightest = 1e-9;
  std::function<bool(const Reference&)> enough;  ///< empty: one level is
  std::function<bool(const Walk&)> afford;       ///< asked along each run; false ends the search; empty: always
};

struct ReferenceFound {
  std::optional<Reference> reference;
  std::optional<Reference> nearest;  ///< where there is none: the finest, of which `enough` was not true
  std::string trouble;               ///< why a run did not come to its end; may be empty
  double cpu_seconds = 0;            ///< of all runs
  bool interrupted = false;
  bool unaffordable = false;  ///< `afford` ended the search
};

/// Runs level after level until two in a row agree.
/// \param model_at gives the model of a point, and keeps it until the search is over
ReferenceFound find_reference(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                              const Outputs& outputs, const ReferenceGoal& goal, const Control& control);

}  // namespace withy::study
