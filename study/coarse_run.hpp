/// \file
/// Coarse runs of a scene in one of its rungs, window of time by window: one that makes the steps, and others that land
/// on them.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "withy/core/simulation/stepping.hpp"
#include "withy/study/control.hpp"
#include "withy/study/corrected_equations.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// What a coarse run has shown of a window.
struct WindowTrack {
  std::vector<double> times;                  ///< of accepted steps [s]; the last is the window's end
  std::vector<std::vector<double>> readings;  ///< of outputs at these times; empty where none was taken
  State end;
};

/// Evaluations over a window beyond which a model is not one to go on with: a hundred for each step of the other.
inline std::size_t most_evaluations(const WindowTrack& other) { return 1000 + 100 * other.times.size(); }

/// One coarse run of some equations.
class CoarseRun {
 public:
  /// In a rung, with the accelerations of a higher one where that is another (CorrectedEquations). All must outlive it.
  /// \param start with its discrete states set
  CoarseRun(const Prepared& prepared, std::size_t low, std::size_t high, const Outputs& outputs,
            const Integrator& integrator, const State& start, double end);
  CoarseRun(const CoarseRun&) = delete;
  CoarseRun& operator=(const CoarseRun&) = delete;

  /// Steps to a time, as it likes. False where it cannot go on, was interrupted, or has spent more evaluations than
  /// `most`.
  bool to(double time, const Control& control, std::size_t most);
  /// The same within `most` evaluations more, and keeps the times of its steps and readings of outputs at least `apart`
  /// [s] from each other.
  /// \param look at the states that are read
  bool track(double time, const Control& control, double apart, std::size_t most,
             const std::function<void(const State&)>& look, WindowTrack& track);
  /// The same at the times of another track: lands on its steps, and reads where it was read.
  bool follow(const WindowTrack& other, const Control& control, WindowTrack& track);

  [[nodiscard]] const State& state() const { return loop_.state(); }
  [[nodiscard]] std::size_t evaluations() const { return loop_.stepper().statistics().evaluations; }
  /// Adds what has been spent since it was last asked, of each rung.
  void charge(std::vector<std::size_t>& evaluations);
  [[nodiscard]] std::vector<double> read() { return reader_.read(state()); }
  [[nodiscard]] double kinetic_energy() const { return reader_.kinetic_energy(); }

 private:
  CorrectedEquations corrected_;
  OutputReader reader_;
  Stepping loop_;
  double read_at_;  ///< time of the last reading
  std::size_t charged_ = 0, samples_charged_ = 0;
};

}  // namespace withy::study
