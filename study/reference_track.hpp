/// \file
/// The coarse run that others are compared with along the way.
#pragma once

#include <string>
#include <vector>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/coarse_run.hpp"

namespace withy::study {

/// A coarse run in a rung that neglects nothing which the accuracy asked can see.
struct ReferenceTrack {
  std::size_t rung = 0;
  std::size_t low = 0;     ///< the rung in which it is made, with the accelerations of `rung`
  std::string integrator;  ///< the one that costs least
  double tolerance = 0;    ///< relative; the absolute one is a hundredth of it
  State start;
  double end = 0;                    ///< of the run [s]
  std::vector<WindowTrack> windows;  ///< they adjoin; fewer than the run's where it ended before
  /// The least rung on the same steps; as many as windows where it went along to the end, else none.
  std::vector<WindowTrack> beside;
  std::string problem;  ///< why it did; else empty
  Distances ranges;     ///< greatest distances of outputs from their start
  double energy = 0;    ///< greatest kinetic energy [J]
  Bend bend;            ///< where it is most, of bodies whose kinematics is not exact (ThirdOrder)
  /// What terms of third order may be off by, of the range of deflections: the rung drops them and no body offers
  /// exact kinematics, or they are too small to look at. 0 where the rung is exact.
  double third_order = 0;
};

/// What lands on the steps of a reference takes them as they are unless they are worse by this.
inline constexpr double looser = 10;

/// What reference tracks are made of; all must outlive it.
class ReferenceTracker {
 public:
  /// \param evaluations of each rung; those made are added
  ReferenceTracker(const Prepared& prepared, Registry& registry, const Outputs& outputs, double accuracy,
                   const Control& control, std::vector<std::size_t>& evaluations);

  /// In the least rung with the accelerations of the highest that expands kinematics to second order, and the least
  /// rung itself beside it: what is to be had where that holds the accuracy, for about its own cost. Ends where the
  /// least rung is far off, or deflections need `exact`; then there is nothing beside.
  ReferenceTrack beside_least();
  /// In the highest rung that expands kinematics to second order; with the accelerations of `exact` where deflections
  /// need it and all bodies offer it. Ends of windows are outputs of the run.
  ReferenceTrack highest();

 private:
  /// What terms of third order leave, as a share of ranges.
  [[nodiscard]] double lacking(const Bend& bend) const;
  ReferenceTrack blank() const;
  bool run(ReferenceTrack& track, double most_bend, bool beside);
  /// Whether the accelerations of another rung can be taken once a step: where loads are stiff (radau was chosen) their
  /// difference is too, and it is taken explicitly.
  bool corrects() const { return integrator_ != "radau"; }
  /// Evaluations over the next `together` windows that say that the correction shortens the steps.
  std::size_t too_many(std::size_t windows_done) const;
  /// Windows over which the least rung goes along at a time.
  std::size_t together() const;

  const Prepared& prepared_;
  Registry& registry_;
  const Outputs& outputs_;
  double accuracy_;
  const Control& control_;
  std::vector<std::size_t>& evaluations_;
  std::size_t second_;  ///< the rung of second order
  double small_;        ///< size of a bend up to which its third order need not be looked at
  double tolerance_;
  State start_;
  double end_;
  std::vector<double> ends_;    ///< of windows [s]
  std::size_t per_window_ = 0;  ///< evaluations, in the least rung
  double seen_ = 0;             ///< greatest size of a bend, of references so far
  std::string integrator_;
};

}  // namespace withy::study
