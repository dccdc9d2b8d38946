/// \file
/// What happens beside a simulation: the progress line and the user's wish to stop.
#pragma once

#include <chrono>
#include <string>

namespace withy::program {

/// From now on SIGINT, SIGTERM and SIGHUP are remembered instead of ending the program; a second one ends it.
void watch_for_interrupt();
/// Whether one of them has come.
bool interrupted();

/// One line on standard error, renewed in place ten times a second and erased at the end, and notes above it, which
/// stay; nothing where standard error is no terminal.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Says that there is something to wait for, before anything is done.
  void begin();
  /// Simulated time reached [s], of a run to `end`; with its rate [s/s] and the time that is left at it.
  void at(double t, double end);
  /// A line that stays, with the time since this was made [s].
  void note(const std::string& text);
  /// Points that are done, of all; with the time that is left at this rate.
  void of_points(double done, double all);

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] bool due() const { return terminal_ && Clock::now() >= next_; }
  void show(const std::string& text);

  std::string label_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point began_, next_;
  double first_ = 0;  ///< time simulated when it was first told
  bool told_ = false;
};

}  // namespace withy::program
