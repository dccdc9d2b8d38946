/// \file
/// What loads tell of themselves in outputs.
#pragma once

#include <vector>

#include "withy/core/plugin/load.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// Numbers of a BoundLoad beside its efforts: a controller's command, error and states. No other load measures them.
class LoadNumbers {
 public:
  virtual ~LoadNumbers() = default;
  /// Their names and units; the same in all formulations.
  [[nodiscard]] virtual std::vector<SensorColumn> numbers() const = 0;
  /// Sets them from a view of the load that has accelerations.
  virtual void show(const LoadView& view, std::span<double> values) const noexcept = 0;
};

}  // namespace withy
