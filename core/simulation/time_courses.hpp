/// \file
/// How long steps may be where loads and motions follow the time by formulas.
#pragma once

#include <cstddef>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Looks at the formulas at 4096 intervals of a run. Where one of them, or its change from interval to interval, begins
/// to change, or to change faster, steps are no longer than it takes to go through the range of that change, until they
/// must have met it: an estimate of an error sees what its stages meet, and from then on it rules alone. What lasts
/// less than an interval may still be passed over.
class TimeCourses {
 public:
  /// \param start, end of the run [s]; without an end nothing is known
  TimeCourses(const Model& model, double start, double end);
  /// Whether anything of a model follows the time by a formula.
  static bool are_in(const Model& model);
  /// The latest end of a step from t [s], later than t; infinite where nothing limits it.
  [[nodiscard]] double latest_end(double t) const;

 private:
  static constexpr std::size_t intervals = 4096;
  double start_ = 0, interval_ = 0;   ///< [s]
  std::vector<double> longest_;       ///< of steps in each interval [s]; infinite: any; empty where none is limited
  std::vector<std::size_t> limited_;  ///< the first interval from each on that is limited; past the last: none
};

}  // namespace withy
