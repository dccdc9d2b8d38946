/// \file
/// Reads all sensors of a scene from states.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// The sensors' numbers, one after the other. Of one thread.
class SensorReader {
 public:
  /// The sensors are bound to the model of the equations, which must outlive the reader.
  /// \throws std::invalid_argument where a body cannot be cut at a section that a sensor asks for.
  SensorReader(std::vector<SensorNode> sensors, const EquationsOfMotion& equations);
  /// Names and units of all numbers, as `tip.x` [m]; none where there are no sensors.
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// Sets one number a column. Allocates nothing. False where the state has no finite accelerations: the numbers then
  /// mean nothing.
  [[nodiscard]] bool read(const State& state, std::span<double> values) noexcept;

 private:
  struct Part {
    std::size_t columns, first_section;
  };
  std::vector<SensorNode> sensors_;
  std::vector<Part> parts_;  ///< one a sensor
  std::vector<Column> columns_;
  std::unique_ptr<SensedState> sensed_;  ///< null: there are no sensors
};

}  // namespace withy
