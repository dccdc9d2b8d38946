/// \file
/// Where along a range of a scene's value each model ceases to hold an accuracy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/crossing.hpp"
#include "withy/study/frequencies.hpp"
#include "withy/study/trade.hpp"

namespace withy::study {

/// One model and, of frequencies, one mode.
struct Threshold {
  Point point;
  std::string mode;  ///< empty: of runs
  Crossing crossing;
  double at_rest = 0;          ///< of a spin that begins at zero: the mode's frequency there [rad/s]; else 0
  std::vector<double> errors;  ///< relative, at the values of the range
};

struct Thresholds {
  std::vector<Threshold> rows;
  std::string reference;  ///< formulation
  int reference_modes = 0;
  double reference_error = 0;  ///< its own, relative
  /// Of frequencies: the least value at which they are those of one angle, since the equations change over a turn.
  std::optional<double> frozen_from;
};

/// By the relative error of whole runs: every value of the range is a trade, and what lies between is looked at where
/// the error passes the limit. Nothing where the user interrupted.
/// \throws InputError, SceneError, PluginError
std::optional<Thresholds> thresholds_of_runs(const Prepared& base, Registry& registry, const std::vector<Point>& points,
                                             const Sweep& range, double limit, const TradeOptions& options);
/// By the relative error of natural frequencies. The same.
std::optional<Thresholds> thresholds_of_frequencies(const Prepared& base, Registry& registry,
                                                    const FrequencyQuestion& question, double limit,
                                                    const Control& control);

/// A point as it is at a value of the range.
Point at_value(Point point, const std::string& path, double value);

}  // namespace withy::study
