/// \file
/// What loads on distributed mass give at frames.
#pragma once

#include "withy/core/plugin/load.hpp"

namespace withy {

/// A SensedState is this too (dynamic_cast).
class SensedFields {
 public:
  virtual ~SensedFields() = default;
  /// The acceleration [m/s²], world axes, that all loads on distributed mass give mass that moves with a frame; the
  /// body −1 is the world.
  [[nodiscard]] virtual Vector3 field(FrameIndex frame) noexcept = 0;
};

}  // namespace withy
