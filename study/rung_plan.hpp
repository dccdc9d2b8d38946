/// \file
/// Which formulation a run of `auto` is in and when: goal-oriented model adaptivity (Oden & Prudhomme, J. Comput. Phys.
/// 182, 2002, 496–515). The goals are the outputs, each within a share of its own range. Before the run two coarse runs
/// of it are compared: one in the highest rung, and one that begins in the least rung and lands on the steps of the
/// first, so that the errors of both steps are nearly the same and their difference is that of the models. It is made
/// in each rung throughout until one holds the accuracy. Where none does, it goes back over a window of time one rung
/// up where its error has used up more than the window's share. As it goes on to the end from every error that it has
/// made, later growth of errors counts.
#pragma once

#include <string>
#include <vector>

#include "withy/study/control.hpp"
#include "withy/study/error_estimate.hpp"

namespace withy::study {

struct PlannedStretch {
  Stretch stretch;
  double use = 0;  ///< greatest share of the accuracy asked that is used up by its end
};

/// An output of the coarse run, to hold the run itself against.
struct PlannedReading {
  double time = 0;             ///< [s]
  std::vector<double> values;  ///< as of OutputReader
};

struct RungPlan {
  std::vector<PlannedStretch> stretches;  ///< adjoining, from the start to the end of the run
  double accuracy = 0;                    ///< asked, of each output's own range
  std::optional<ErrorEstimate> estimate;  ///< greatest estimated errors; nothing where none could be made
  /// All of the run is in the rung that errors are estimated against: there is no difference to estimate.
  bool throughout = false;
  double use = 0;     ///< greatest of the errors over what is allowed
  std::string worst;  ///< output of which that is so; empty where there is no difference
  /// A rung above the one that errors are estimated against, that was not run since what it adds is small at an
  /// instant: its name, empty where there is none; and that, of the range of deflections (third_order_share). It is in
  /// `use` as it is there; over a run it may come to hundreds of times that, and how much is not known.
  std::string above;
  double above_share = 0;
  /// Why the error is not known, or not to be held; else empty.
  std::string problem;
  std::string integrator;                    ///< of the coarse runs; empty: there were none
  std::vector<std::size_t> evaluations;      ///< of the coarse runs, in each rung
  std::vector<std::size_t> run_evaluations;  ///< of the run itself, in each rung, those of its watches among them
  std::size_t windows = 0, repeated = 0;     ///< of time; tries of a window that were not kept
  std::vector<PlannedReading> readings;      ///< at the ends of windows
  /// Of a run that is in one rung throughout, once it is made: the greatest part of an output's range that another run
  /// in it is off, and why its error is not known (OtherRuns).
  double apart = 0;
  std::string sensitive;
  Distances scales;  ///< that errors are relative to
};

/// Plans the run of a scene in formulation `auto`. The same scene gives the same plan, bit by bit.
/// \param accuracy of each output's own range
/// \throws InputError where an integrator of the coarse runs is missing.
RungPlan plan_rungs(const Prepared& prepared, Registry& registry, double accuracy, const Control& control);

/// The accuracy that the scene asks of `auto`.
double asked_accuracy(const Scene& scene);

}  // namespace withy::study
