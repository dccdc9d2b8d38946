/// \file
/// The run that errors are measured against, and how well it is known: the one search of every study.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/control.hpp"
#include "withy/study/series.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {

/// What errors are measured against, richest first: the rungs of `auto` that truncate nothing. The first that every
/// body of a scene can be in is taken.
std::vector<std::string> reference_formulations(Registry& registry);

/// A run whose outputs are the truth, and how true they are.
struct Reference {
  Point point;
  /// Where what a higher formulation adds was found at fewer modes and put on top: that run's.
  std::optional<Point> added_by = {};
  Readings readings;          ///< of the run; where it is one of a series of modes, where that leads to
  bool extrapolated = false;  ///< it leads beyond the run
  Distances ranges;           ///< greatest distances of outputs from their start
  double energy = 0;          ///< greatest kinetic energy at an output [J]
  Distances scales;           ///< what relative errors are shares of
  Distances own;              ///< what the readings may be off by (ModeSeries, ThirdOrder); empty: not known
  Bend bend = {};             ///< of the bodies whose kinematics is not exact, where most (ThirdOrder)
  std::string bent = {};      ///< the body that this is of; empty where none bends
  double third_order = 0;     ///< share of the scales in `own` that is of it
  Walk walk;
  Readings coarser = {};  ///< of the level before, of the nearest alone
  /// "exact, 5 modes, dop853 at 1e-07", "exact, 5 modes, dop853 at 1e-07, extrapolated".
  [[nodiscard]] std::string text() const;
};

/// Of how many kinds modes that follow each other are. Those of a whole body, as a plate's, are in the order of their
/// frequencies, bending, twist and bending across, and a motion may excite one kind alone: then the mode that was added
/// last may change nothing, and the next one much.
int kinds_of_modes(const Scene& scene);

/// Where a search begins and when it ends.
struct ReferenceGoal {
  Point first;  ///< the coarsest; its formulation means nothing
  /// Families beside that of `first`: the one is taken whose first added mode changes clearly less, in the lowest rung
  /// that truncates nothing; and one whose series there is known clearly better, when there are more modes.
  std::vector<std::string> families;
  /// Finer ones that are looked at: modes more where the first has any, the tolerance times `finer` down to `tightest`.
  int levels = 1;
  int kinds = 1;  ///< kinds_of_modes
  /// Whether levels with many modes are next_step() apart, as it pays where nobody knows how many it takes; else each
  /// has a mode more.
  bool leaps = false;
  double finer = 0.1;
  double tightest = 1e-9;
  /// What integration adds to a level, where that is its `own`, over what it may add. Each level then has the
  /// integrator that costs least there, of that of `first` and `imex`, at the tolerance at which it adds no more: runs
  /// of the coarsest tell, in the lowest rung that truncates nothing, and runs of a level that has many more modes.
  /// Empty, or without modes: levels have the integrator of `first`, and its tolerance by `finer`.
  std::function<double(const Reference&)> integration;
  std::vector<Reference> made = {};              ///< runs that need not be made again
  std::function<bool(const Reference&)> enough;  ///< empty: one level is
  /// Whether what a higher rung adds has changed little enough with the last mode, as `own`; empty: never.
  std::function<bool(const Reference&)> steady;
  std::function<double()> left;  ///< CPU time that all runs to come may take [s]; empty: any
  /// Asked along each run, with what it is expected to cost as evaluations have grown with modes [s], infinite where
  /// that is not known; false ends the search; empty: always.
  std::function<bool(const Walk&, double whole)> afford;
  std::function<void(const Walk&)> ended;  ///< told of each run that has come to its end; may be empty
};

struct ReferenceFound {
  std::optional<Reference> reference;
  std::optional<Reference> nearest;  ///< where there is none: the finest, of which `enough` was not true
  std::vector<Reference> runs;       ///< all that came to their end, the points in no order
  std::string trouble;               ///< why a run did not come to its end; may be empty
  double cpu_seconds = 0;            ///< of all runs
  bool interrupted = false;
  bool unaffordable = false;  ///< `afford` ended the search
};

/// Runs level after level until where they lead to is known well enough (ModeSeries). Where an evaluation of a lower
/// rung that truncates nothing costs a fraction, or another level cannot be afforded, more modes are looked at there,
/// and what the higher one adds is that of the last level: u(low, many) + u(high, few) − u(low, few), the combination
/// of Griebel, Schneider & Zenger (1992). How much that changed from the level before counts as error. \param model_at
/// gives the model of a point, and keeps it until the search is over
ReferenceFound find_reference(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                              const Outputs& outputs, const ReferenceGoal& goal, const Control& control);

}  // namespace withy::study
