/// \file
/// What happens beside a simulation: the progress line and the user's wish to stop.
#pragma once

#include <chrono>
#include <string>

namespace withy::app {

/// From now on SIGINT is remembered instead of ending the program; a second one ends it.
void watch_for_interrupt();
/// Whether SIGINT has come.
bool interrupted();

/// One line on standard error, renewed in place ten times a second and erased at the end; nothing where standard error
/// is no terminal.
class Progress {
 public:
  Progress(std::string label, double end);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Simulated time reached [s].
  void at(double t);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  double end_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

}  // namespace withy::app
