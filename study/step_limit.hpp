/// \file
/// What limited the steps of a run.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/simulation/accuracy.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

struct StepLimit {
  double mean = 0;     ///< [s]
  double fastest = 0;  ///< modulus of the fastest pole at the end, of all that acts [1/s]
  /// The same of what moves in the run [1/s]: of coordinates whose rates stay far below the tolerance of error control
  /// none limits steps. `fastest` where nothing rests; 0 where all does.
  double moving = 0;
  std::string resting = {};     ///< the coordinate that makes `fastest` more than `moving`; empty where none does
  double product = 0;           ///< mean step times `moving`; 0 where it is not known, or nothing is fast
  std::string maker = {};       ///< what makes what moves so fast, in words; empty where it is not known
  bool made_by_load = false;    ///< a load does
  std::optional<double> limit;  ///< of that product, beyond which the integrator is not stable
  /// What helps against stability: the mode without which the fastest vibration is slowest, and the integrators of
  /// those there are that no vibration limits and that can integrate these equations. Empty where nothing is proposed.
  std::optional<Slowing> fewer;
  std::vector<std::string> unlimited;
  bool controlled = true;  ///< the integrator chooses its steps by `rtol`
  bool chosen = false;     ///< it has neither `rtol` nor `step`, and its steps have differed
  double longest =
      std::numeric_limits<double>::infinity();  ///< step that it may choose: max_step, or between samples [s]
  /// "stability", "accuracy", "given" (by the scene, as fixed steps always are and those that it allows no longer),
  /// "chosen" (by the integrator, nobody else knows how) or "unknown". Error control that meets the limit goes to and
  /// fro about it, so the mean stays a little below.
  [[nodiscard]] std::string cause() const;
  /// Steps that are chosen go far beyond the limit: what is so fast rests for the most part, or began at the end.
  [[nodiscard]] bool fastest_rests() const;
};

/// Of a run of a model, from the scene's initial state on, by the vibrations of its modes and without proposals.
/// \param absolute tolerance of an integrator that chooses its steps
StepLimit step_limit(const Prepared& prepared, const Integrator& integrator, double absolute,
                     const RunSummary& summary);
/// Of a run of the scene itself; where stability limited it, with proposals.
StepLimit step_limit(const Prepared& prepared, const RunSummary& summary, Registry& registry);

/// What an integrator cannot follow to the end of a run.
struct TooStiff {
  double step = 0;   ///< [s] the longest that it is stable to
  double steps = 0;  ///< of them to the end
  std::string text;  ///< both, and what makes them so, in a clause
};
/// Where the steps to which the scene's integrator is stable about a state are more than `most_steps` up to the end of
/// the run. Nothing where they are not, or where it is not known: of more than 200 speeds.
std::optional<TooStiff> too_stiff(const Prepared& prepared, const State& state,
                                  std::size_t most_steps = RunOptions().most_steps);
/// Gives runs of a scene, which must outlive them, what they ask of its poles, and of the course of its
/// loads and motions in time: RunOptions::too_stiff and too_fast.
void watch_poles(const Prepared& prepared, RunOptions& options);

}  // namespace withy::study
