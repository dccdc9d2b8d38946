/// \file
/// Extremes and means of outputs over a run, between its rows of results too.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/step_parts.hpp"
#include "withy/core/simulation/step_watch.hpp"

namespace withy {

/// What one number of an output was over a run, without the steps in which it was none somewhere. Where it never was,
/// extremes, mean and rms are not numbers.
struct OutputStatistics {
  std::string name, unit;
  double least = 0, least_at = 0;        ///< and its time [s]
  double greatest = 0, greatest_at = 0;  ///< and its time [s]
  double integral = 0;                   ///< over time [unit s]
  double square = 0;                     ///< the integral of its square
  double span = 0;                       ///< time that these are of [s]
  [[nodiscard]] double mean() const { return span > 0 ? integral / span : least; }
  [[nodiscard]] double rms() const;
};

/// Reads outputs at five places of each part of an accepted step (StepParts), on its dense output: integrals are
/// Boole's, and where a parabola through three places promises an extreme beyond those known the output is read there,
/// twice. Depends on no output interval. Of one thread.
class StatisticsWatch final : public StepWatch {
 public:
  /// \param sensors all of the scene, bound to the model of the equations, which must outlive it
  /// \param watched names of those whose statistics are asked for
  /// \param jumps times [s] at which loads or motions of the model jump, increasing, as `discontinuities` has them
  StatisticsWatch(const std::vector<SensorNode>& sensors, const std::vector<std::string>& watched,
                  const EquationsOfMotion& equations, std::vector<double> jumps, StepParts parts);
  void begin_at(const State& state) override;
  void observe(const Stepper& stepper) override;
  void remember(Memory& memory) override;
  /// One a number of the watched outputs.
  [[nodiscard]] const std::vector<OutputStatistics>& results() const { return results_; }

 private:
  static constexpr std::size_t places = 5;
  /// Sets one number a result, not a number where the state has none.
  void read(const State& state, std::vector<double>& values);
  /// The same at the end of a step, which no jump there belongs to.
  void read_end(const State& state, std::vector<double>& values);
  void note(double t, const std::vector<double>& values);
  /// The part from from_ to a time, which becomes from_.
  void observe_part(const Stepper& stepper, double to);
  void add_part(std::size_t result, double h);
  void refine(const Stepper& stepper, std::size_t result, double h, double sign);

  SensorReader reader_;
  std::vector<double> jumps_;         ///< times at which loads or motions jump; steps end there
  std::vector<std::size_t> columns_;  ///< of the reader, one a result
  std::vector<OutputStatistics> results_;
  std::vector<double> all_, now_;
  std::array<std::vector<double>, places> within_;  ///< the first is that of where the step began
  double from_ = 0;                                 ///< [s], where the next part begins
  State between_;
  StepParts parts_;
};

}  // namespace withy
