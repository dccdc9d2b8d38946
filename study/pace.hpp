/// \file
/// What the rest of a run will cost, judged by what it has cost so far.
#pragma once

#include <utility>
#include <vector>

namespace withy::study {

/// The start of a run is not like the rest: its steps grow from a first guess, what was let go rings until damping has
/// taken it, memory is cold. A run of the same scene that has come to its end shows which share of its cost it had up
/// to the same time, and another is taken to be like it; where there was none, the pace is that of the later half of
/// the CPU time spent.
class Pace {
 public:
  /// How far a run has come [s] for what CPU time [s]; less of that than before begins another run.
  void note(double gone, double seconds);
  /// The run that was noted has come to its end: those that follow are like it.
  void end();
  /// CPU time [s] for going on to `whole` [s] at that pace; infinite where nothing is gained, 0 where nothing is noted.
  [[nodiscard]] double rest(double whole) const;

 private:
  using Notes = std::vector<std::pair<double, double>>;  ///< gone and seconds, in their order
  Notes noted_;
  Notes ended_;  ///< of the last run that came to its end
};

/// Whether a run may go on whose rest is known: it is cut where that goes beyond what is left, but not before it has
/// had a share of it to show its pace.
/// \param seconds CPU time of this run, \param left of all that may be spent when it began, both [s]
bool may_go_on(double seconds, double rest, double left);

}  // namespace withy::study
