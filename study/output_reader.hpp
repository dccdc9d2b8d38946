/// \file
/// Values of outputs at the states of a run.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/measures.hpp"

namespace withy::study {

/// Reads outputs from states of one model. What is given must outlive it.
class OutputReader {
 public:
  /// \param sensors of the scene, bound to this model; all that outputs were made with
  OutputReader(const Outputs& outputs, const Model& model, const EquationsOfMotion& equations,
               std::vector<SensorNode> sensors = {});
  /// The numbers of all outputs; an effort or a sensor that cannot be found is no number.
  /// States are read in the order of time: what outputs have been over the run is of those read.
  [[nodiscard]] std::vector<double> read(const State& state);
  /// At the state read last [J].
  [[nodiscard]] double kinetic_energy() const { return energies().kinetic; }
  [[nodiscard]] Energies energies() const { return seen_->energies(); }

 private:
  [[nodiscard]] std::span<const double> rates_of(std::span<const double> y, std::size_t hinge) const;
  const Outputs& outputs_;
  const Model& model_;
  const EquationsOfMotion& equations_;
  std::unique_ptr<Observation> seen_;
  std::vector<Tip> tips_;
  Work work_;
  std::vector<double> efforts_;
  std::optional<SensorReader> sensors_;  ///< nothing where no output is a sensor's
  std::vector<double> sensed_;
  /// Of an output over time: what it was last and has been, its integrals by the trapezoidal rule.
  struct Course {
    bool begun = false;
    double from = 0, time = 0, first = 0, last = 0, least = 0, greatest = 0, integral = 0, square = 0;
    void note(double t, double value);
    [[nodiscard]] double result(Output::Shape over) const;
    [[nodiscard]] double range(Output::Shape over) const;
  };
  std::vector<Course> courses_;  ///< one an output
};

}  // namespace withy::study
