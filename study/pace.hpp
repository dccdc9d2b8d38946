/// \file
/// What the rest of a run will cost, judged by what it has cost so far.
#pragma once

#include <utility>
#include <vector>

namespace withy::study {

/// The start of a run is not like the rest: its steps grow from a first guess, what was let go rings until damping has
/// taken it, memory is cold. So the pace is that of the later half of the CPU time spent.
class Pace {
 public:
  /// How far a run has come [s] for what CPU time [s]; less of that than before begins another run.
  void note(double gone, double seconds);
  /// CPU time [s] for going on to `whole` [s] at that pace; infinite where nothing is gained, 0 where nothing is noted.
  [[nodiscard]] double rest(double whole) const;

 private:
  std::vector<std::pair<double, double>> noted_;  ///< gone and seconds, in their order
};

/// Whether a run may go on whose rest is known: it is cut where that goes beyond what is left, but not before it has
/// had a share of it to show its pace.
/// \param seconds CPU time of this run, \param left of all that may be spent when it began, both [s]
bool may_go_on(double seconds, double rest, double left);

}  // namespace withy::study
