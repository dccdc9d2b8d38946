/// \file
/// What is thrown where a simulation cannot go on.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace withy::host {

/// what() is the physical reason. The simulation stands at its last accepted state.
class SimulationStopped : public std::runtime_error {
 public:
  SimulationStopped(std::string status, const std::string& reason, double time)
      : std::runtime_error(reason), status_(std::move(status)), time_(time) {}
  /// As in run.json: "diverged", "singular", "step-underflow", "interrupted", "load-failed".
  [[nodiscard]] const std::string& status() const { return status_; }
  [[nodiscard]] double time() const { return time_; }  ///< of the last accepted state [s]

 private:
  std::string status_;
  double time_;
};

}  // namespace withy::host
