/// \file
/// Events: functions of the state whose zeros a run looks for.
#pragma once

#include <functional>
#include <span>
#include <string>

namespace withy {

/// A function of the state whose zeros are looked for in a run.
struct RunEvent {
  std::string name;
  std::function<double(double t, std::span<const double> y)> function;  ///< continuous; y as in State
  int direction = 0;   ///< +1: from below alone, −1: from above alone
  bool stops = false;  ///< the run ends there, completed
  /// Whether it looks at all in a state; empty: always. Where it does not, the function is zero.
  std::function<bool(std::span<const double> y)> looks = {};
};

/// Where an event's function was zero.
struct EventTime {
  std::string name;
  double time = 0;    ///< [s]
  int direction = 0;  ///< +1: from below, −1: from above
};

}  // namespace withy
