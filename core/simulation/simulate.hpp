/// \file
/// Runs a model from a state to a time, watching what can go wrong: the loop that applications embed.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/run_event.hpp"
#include "withy/core/simulation/validity.hpp"

namespace withy {

class ChangingEquations;

/// How a run ended.
enum class RunStatus {
  completed,
  inaccurate,  ///< it came to the end, but energy and work do not balance, or a hinge has left its motion
  diverged,
  singular,
  step_underflow,
  interrupted,
  load_failed,  ///< a load whose law is not the engine's own has failed
  too_stiff     ///< the steps that the integrator is stable to never come to the end
};
/// "completed", "inaccurate", "diverged", "singular", "step-underflow", "interrupted", "load-failed", "too-stiff".
std::string_view name(RunStatus status);

/// A run between two steps: `simulate` restores it and, with the same arguments otherwise, goes on as if it had not
/// ended, bit by bit.
struct Checkpoint {
  State state;
  std::vector<double> stepper;  ///< Stepper::memory
  std::vector<double> watches;  ///< what the run has seen so far
};

struct RunSummary;

struct RunOptions {
  double end = 0;                 ///< [s]
  double output = 0.01;           ///< interval of outputs [s]; the end is always one
  double deflection_limit = 1.0;  ///< a deflection past this many lengths of its body is divergence
  /// Greatest RunSummary::energy_drift that the formulation and the tolerance explain; a run that comes to the end with
  /// more is inaccurate. Infinite where the formulation does not conserve energy.
  double drift_limit = std::numeric_limits<double>::infinity();
  /// The energy whose drift is looked at has ½ uᵀ M u of the equations' own mass matrix and their own potential of
  /// weight in the place of those without truncation: that is what a symmetric truncation conserves.
  bool own_energy = false;
  /// Motion with no speed above this [m/s, rad/s] is rounding, and its energy balances or not.
  double least_speed = 1e-12;
  /// As the stepper counts its steps or, where it counts too few, as it was asked for them.
  std::size_t most_steps = 100'000'000;
  /// Asked now and then where at the pace of the steps so far, or of the later half of very many, `most_steps` are too
  /// few to come to the end: why they are from this state on as well, in a clause without a full stop, which ends the
  /// run; empty: it goes on.
  std::function<std::string(const State&)> too_stiff;
  /// Asked of a run that came to its end with more drift of energy than any stable integration leaves, where the
  /// formulation need not conserve it and no elastic mode says why: what of its motion is too fast for steps of this
  /// size [s], in a sentence that names them; empty: nothing is.
  std::function<std::string(const RunSummary&, double)> too_fast;
  double most_seconds = 0;            ///< wall time; 0: unlimited
  std::function<bool()> interrupted;  ///< asked between steps
  std::vector<RunEvent> events;       ///< looked for on the dense output; those that do not stop do not change the run
  bool past_stops = false;            ///< an event that ends a run acts as any other, and the run goes on to its end
  std::function<bool()> checkpoint_due;               ///< asked between steps: whether `checkpoint` is to be called
  std::function<void(const Checkpoint&)> checkpoint;  ///< called then and when the run is interrupted
  std::function<void(Memory&)> remember;              ///< what else goes into checkpoints, and comes back on a resume
  const Checkpoint* resume = nullptr;                 ///< where to go on; null: begin at the initial state
  /// Equations that change along the run, the ones it is made with: they go over at their own times. Null: they stay.
  ChangingEquations* changing = nullptr;
  /// Of these equations: brought to the state of each output before it is given, so that a row of results costs no
  /// second pass. Null: the run uses its own.
  Observation* seen = nullptr;
  /// Equations of the same model that neglect less, for RunSummary::validity; null where there are none.
  const EquationsOfMotion* beyond = nullptr;
};

/// Greatest change of the momenta of a tree that nothing outside acts on, over the states that energy is looked at in:
/// of the angular one over each eighth of them and the last.
struct MomentumDrift {
  /// The tree floats freely: no weight, and no load acts on it from outside. What its bodies do to each other does not.
  bool conserved = false;
  double linear = 0;   ///< |P(t) − P(0)| over `linear_scale`
  double angular = 0;  ///< |L(t) − L(0)| about the mass centre c over `angular_scale`
  /// √(2 m T), and |L(0)| or, where that is less than a tenth of it, √(2 T Σ m |r − c|²): what the kinetic energy T of
  /// motion relative to the mass centre could carry, the greatest over the run. Neither the origin of the world nor a
  /// velocity that all have in common is in them [kg m/s, kg m²/s].
  double linear_scale = 0, angular_scale = 0;
};

/// What a run leaves behind, whatever its end.
struct RunSummary {
  RunStatus status = RunStatus::completed;
  std::string message;  ///< the physical reason, or what a completed run should not keep to itself; else empty
  /// The last accepted state. Of a run that ended badly or is inaccurate: the last one that can be trusted, at which M
  /// had not changed the sign of its determinant and energy and work balanced to within the limit or half of the
  /// energy.
  State final;
  double reached = 0;            ///< time of the last accepted state [s]
  bool ended_by_event = false;   ///< completed where an event of the scene ended it, before its time
  bool past_deflection = false;  ///< a deflection past RunOptions::deflection_limit ended it
  /// Greatest |deflection| of the tip of each body that has modes and a "tip", over all accepted steps and, between
  /// them, along the cubic through their coordinates and rates; body axes x, y, z [m]. Of a body in segments under its
  /// own name, over the accepted steps. None of these depends on the output interval.
  std::map<std::string, std::array<double, 3>> peak_deflection;
  /// Of each body that has modes and a measured station (Body::measured_station), the greatest distance of that from
  /// its undeformed place, over the body's length.
  std::map<std::string, double> peak_deflection_ratio;
  /// Of each of these the greatest angle [rad] by which the section there is turned against the body's frame, to the
  /// first order in the coordinates, over the accepted steps at which the body is bent (Bend).
  std::map<std::string, double> peak_section_angle;
  /// Greatest |effort| of the loads on each generalized speed over all accepted steps, their middles and the outputs.
  std::vector<double> peak_effort;
  /// The same of the efforts that motions need.
  std::vector<double> peak_motion_effort;
  /// Greatest |E(t) − E(0) − work| over the first 256 accepted states, every fourth of the others and the last,
  /// relative to the greatest of |E|, |work| and kinetic energy seen.
  double energy_drift = 0;
  double energy_scale = 0;  ///< that greatest [J]
  /// The same of the energy without truncation: what a formulation with an energy of its own leaves out shows there.
  double untruncated_drift = 0;
  MomentumDrift momentum;
  std::vector<EventTime> events;  ///< in their order
  std::size_t switchings = 0;     ///< of loads, at zeros of their switching functions
  /// Times [s] at which steps were rejected as they are where a load jumps without having declared it.
  std::vector<double> suspected_jumps;
  /// A motion without a finite coordinate at an accepted state or an output, which integrators do not see, for they ask
  /// for accelerations alone.
  struct LostMotion {
    std::string name;  ///< empty: there is none
    double time = 0;   ///< the first such [s]
  } lost_motion;
  Conditioning conditioning;  ///< at the final state; empty where there are more than 200 generalized speeds
  /// Greatest √ of the eigenvalues of M⁻¹K there, of the motions that keep loops closed [rad/s]; 0 where they were not
  /// looked at.
  double fastest_mode = 0;
  Validity validity;
  StepStatistics steps;
  double cpu_seconds = 0;  ///< of this thread; of a run that was resumed with those before its checkpoint
};

/// Integrates from `initial`; `output` receives the state there, at every multiple of the output interval (interpolated
/// within the steps, so outputs do not change the result) and at the end, whatever it is. Steps land on discontinuities
/// of the loads, on the instants of their discrete states and on the end, where time is RunOptions::end bit by bit.
/// A run that is resumed gives the outputs after its checkpoint.
/// \throws std::invalid_argument where the end lies before the initial time, the output interval is not positive, or
/// the checkpoint is not one of such a run.
RunSummary simulate(const Model& model, const EquationsOfMotion& equations, const Integrator& integrator,
                    const State& initial, const RunOptions& options, const std::function<void(const State&)>& output);

}  // namespace withy
