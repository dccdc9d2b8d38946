/// \file
/// Peaks of the efforts of loads and motions along a run.
#pragma once

#include <array>
#include <vector>

#include "withy/core/plugin/memory.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy {

/// Watches the efforts of a run from its start on; the greatest |efforts| go to its summary. It looks at each accepted
/// state, at what the last evaluation there has found; where three states in a row say that an effort has its greatest
/// value between them, it looks there too; what is far beyond all three there is of a motion that the steps do not
/// resolve, as a stiff spring's under long implicit ones, and no effort. What it finds does not depend on the outputs.
class EffortWatch {
 public:
  /// \param span of the run [s]: steps longer than a fiftieth of it are looked into
  EffortWatch(const Model& model, const EquationsOfMotion& equations, double span, RunSummary& summary);

  /// To be called at the start, and wherever efforts may have jumped.
  void begin_at(const State& state);
  /// To be called after each accepted step; looks at nothing where `begin_at` has not been called.
  void observe(const Stepper& stepper);
  void remember(Memory& memory);

 private:
  struct Sample {
    State state;
    std::vector<double> loads, motions;  ///< efforts on all speeds [N m, N]
  };
  [[nodiscard]] bool idle() const { return loads_.empty() && motions_.empty(); }
  [[nodiscard]] const Sample& back(std::size_t i) const { return samples_[(newest_ + samples_.size() - i) % 3]; }
  void push(const Stepper& stepper);
  void evaluate(Sample& sample);
  void raise(const Sample& sample);
  void raise_resolved();
  [[nodiscard]] bool hides_a_peak() const;
  void look_between(const Sample& before, const Sample& after);

  const EquationsOfMotion& equations_;
  std::size_t positions_, speeds_;
  std::span<double> loads_, motions_;  ///< peaks in the summary; empty where there are none to watch
  double longest_;                     ///< [s]
  std::array<Sample, 3> samples_;      ///< the last accepted states since the last jump, a ring
  std::size_t newest_ = 0, count_ = 0;
  Sample between_;
  std::vector<double> rates_, rates_before_;
  Work work_;
};

}  // namespace withy
