/// \file
/// Coarse runs of a scene in one of its rungs, window of time by window: one that makes the steps, and others that land
/// on them.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "withy/core/simulation/stepping.hpp"
#include "withy/study/control.hpp"
#include "withy/study/measures.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// What a coarse run has shown of a window.
struct WindowTrack {
  std::vector<double> times;                  ///< of accepted steps [s]; the last is the window's end
  std::vector<std::vector<double>> readings;  ///< of outputs at these times; empty where none was taken
  State end;
};

/// One coarse run of some equations.
class CoarseRun {
 public:
  /// All must outlive it. \param start with its discrete states set
  CoarseRun(const Prepared& prepared, const EquationsOfMotion& equations, const Outputs& outputs,
            const Integrator& integrator, const State& start, double end);

  /// Steps to a time, as it likes. False where it cannot go on, was interrupted, or has spent more evaluations than
  /// `most`.
  bool to(double time, const Control& control, std::size_t most);
  /// The same, and keeps the times of its steps and readings of outputs at least `apart` [s] from each other.
  bool track(double time, const Control& control, double apart, WindowTrack& track);

  [[nodiscard]] const State& state() const { return loop_.state(); }
  [[nodiscard]] std::size_t evaluations() const { return loop_.stepper().statistics().evaluations; }
  [[nodiscard]] std::vector<double> read() { return reader_.read(state()); }
  [[nodiscard]] double kinetic_energy() const { return reader_.kinetic_energy(); }

 private:
  OutputReader reader_;
  Stepping loop_;
  double read_at_;  ///< time of the last reading
};

}  // namespace withy::study
