/// \file
/// The linear model of small motions about a state, ż = A z + B v, y = C z + D v, with names; where loads are sampled,
/// the exact map from one sample to the next.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "withy/core/analysis/linear_system.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

struct LinearModel {
  /// Displacements of the free speeds, their rates, continuous states of loads; of a sampled model then what its loads
  /// hold.
  std::vector<std::string> states;
  std::vector<Column> inputs;   ///< values of input loads, or efforts on speeds [N m, N]
  std::vector<Column> outputs;  ///< components of sensors; coordinates, rates, deflections and places of tips
  std::vector<double> output_values;
  LinearSystem system;
  std::vector<std::pair<std::string, double>> accelerations;  ///< of the free speeds at the state
  bool equilibrium = false;                                   ///< nothing that is free moves or begins to
  /// The model is that of one instant and tells no stability: A, B, C or D changes as hinges go on that move, or as
  /// time does by itself.
  bool frozen = false;
  std::vector<std::string> shaking;  ///< loads by which time changes A, where no hinge does that moves; no inputs
  /// Where neither changes A between samples: sampled loads, and loads whose loop is opened, of which what they make of
  /// small motions changes as hinges go on.
  std::vector<std::string> turning_loads;
  std::vector<std::string> turning_inputs;   ///< where A does not change: what they do to small motions does
  std::vector<std::string> turning_outputs;  ///< the same: what they show of small motions
  std::vector<std::string> timed_outputs;    ///< the same: time by itself changes what they show of small motions
  std::vector<std::string> moving_outputs;   ///< their values move, by hinges that go on or by time
  std::vector<std::string> changing;  ///< loads whose gain changes with time by itself: it is that at the state's time
  std::vector<std::string> limited;   ///< loads that are at their limits there
  std::string derivatives;            ///< how A was found
  std::string output_derivatives;     ///< how C and D were
};

/// What goes in and comes out.
struct Ports {
  /// Input loads, hinges or speeds; `all` is every speed; empty: every input load or, where there is none, every hinge.
  std::vector<std::string> inputs;
  /// Names or their beginnings up to a dot, of the scene's sensors and of what every model has; empty: every sensor or,
  /// where there is none, everything else.
  std::vector<std::string> outputs;
};

/// Sampled loads are discretised exactly: z are values just before a sample, y those just after it, v is held from it
/// to the next. Of loads with several periods the common one counts, through which v is held. \throws InputError where
/// there is no such input or output, or no common period; std::domain_error where the mass matrix of what is free is
/// singular.
LinearModel linear_model(const Configuration& configuration, const Ports& ports);

/// What is to be known where A is that of one instant, a sentence without a full stop; empty elsewhere.
std::string note_of_frozen(const LinearModel& linear);
/// The same where outputs move by themselves, and what is told is of deviations from that.
std::string note_of_moving(const LinearModel& linear);
/// The same where loads change their gain. \param time [s] of the state
std::string note_of_changing(const LinearModel& linear, double time);

}  // namespace withy::study
