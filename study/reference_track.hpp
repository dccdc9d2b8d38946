/// \file
/// The coarse run that others are compared with along the way.
#pragma once

#include <string>
#include <vector>

#include "withy/study/coarse_run.hpp"

namespace withy::study {

/// A coarse run in a rung that neglects nothing which the accuracy asked can see.
struct ReferenceTrack {
  std::size_t rung = 0;
  std::string integrator;  ///< the one that costs least
  double tolerance = 0;    ///< relative; the absolute one is a hundredth of it
  State start;
  double end = 0;                    ///< of the run [s]
  std::vector<WindowTrack> windows;  ///< they adjoin; fewer than the run's where it ended before
  std::string problem;               ///< why it did; else empty
  Distances ranges;                  ///< greatest distances of outputs from their start
  double energy = 0;                 ///< greatest kinetic energy [J]
  double deflection = 0;             ///< greatest of a tip over its body's length
  /// What terms of third order in the deflection may be off by, of its range: the rung drops them and no body offers
  /// exact kinematics, or they are too small to look at. 0 where the rung is exact.
  double third_order = 0;
};

/// Runs the highest rung that expands kinematics to second order; `exact` where deflections need it and all bodies
/// offer it. Ends of windows are outputs of the run.
/// \param evaluations of each rung; those made are added
ReferenceTrack track_reference(const Prepared& prepared, Registry& registry, const Outputs& outputs, double accuracy,
                               const Control& control, std::vector<std::size_t>& evaluations);

}  // namespace withy::study
