/// \file
/// Why a simulation cannot go on.
#pragma once

#include <optional>
#include <string>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/core/simulation/stepping.hpp"

namespace withy {

/// Why stepping ended before its end.
struct Stop {
  RunStatus status = RunStatus::completed;
  std::string reason;    ///< a clause without its full stop
  bool physical = true;  ///< the equations are the reason, not the caller
};

/// A motion that ceases to have finite numbers.
struct NonfiniteMotion {
  std::string name;
  std::string quantity;  ///< "coordinate", "rate" or "acceleration"
  double time = 0;       ///< [s]
};
/// The first without finite numbers from a time [s] on; nothing where there is none until `ahead` [s] after it.
std::optional<NonfiniteMotion> nonfinite_motion(const Model& model, double time, double ahead);

/// The reason that stepping itself gives: no step can be made, or switches follow each other without time between.
/// Completed where it gives none.
Stop stop_of(const SteppingEnd& end, const Model& model, const EquationsOfMotion& equations, const State& state,
             const Stepper& stepper);

/// Whether no step shorter than those given was tried: the integrator chooses none, and halves none that fails.
bool tried_as_given(const Stepper& stepper);

/// Says that steps are beyond what the integrator is stable to, and ends with a blank; empty where they are not.
/// \param mean_step [s] of the accepted steps
std::string steps_too_long(const RunSummary& summary, const Integrator& integrator, double mean_step);

/// Whether a run that came to its end is to be believed whatever its fastest mode: `imbalance` has nothing to say.
bool surely_balanced(const RunSummary& summary, const RunOptions& options);

/// Why a run that came to its end is not to be believed, with the steps first where they are beyond what the integrator
/// is stable to; empty where it is.
/// \param mean_step [s] of the accepted steps
std::string imbalance(const RunSummary& summary, const RunOptions& options, const Integrator& integrator,
                      double mean_step);

/// "t = 0.0523 s: <reason>. <what the mass matrix is like>". Steps that collapse where M loses rank collapse because of
/// it: the status then becomes singular.
/// \param history of the mass matrix; null where it has too many rows to be examined
std::string explain(Stop& stop, double time, const MassMatrixHistory* history, const Layout& layout);

}  // namespace withy
