/// \file
/// A look at what the sensors of a scene ask for, before anything is computed with them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// Reads sensors once of a state that is none, the model at its reference, where nothing is known but times and
/// coordinates.
class SensorProbe {
 public:
  /// \param model complete but for its sensors; must outlive this
  explicit SensorProbe(const Model& model);
  ~SensorProbe();
  SensorProbe(SensorProbe&&) noexcept;

  /// What the sensor asks for that the model has not, as "it asks for frame 7 of body 'arm', …"; empty where there is
  /// all of it. To be called for the sensors of a scene in their order: those behind see the numbers of those before.
  [[nodiscard]] std::string fault_of(const BoundSensor& sensor);

 private:
  class Asked;

  std::unique_ptr<Asked> asked_;
  std::vector<double> values_;  ///< of the sensors so far
};

}  // namespace withy
