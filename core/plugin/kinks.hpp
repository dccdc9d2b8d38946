/// \file
/// Where the efforts of a load have kinks.
#pragma once

#include <cstddef>
#include <span>

namespace withy {

/// A BoundLoad may be this too (dynamic_cast): its efforts are smooth but where functions of the motion are zero, as at
/// a stop. An estimate of an error sees what the stages of a step meet; a step that goes beyond a kink and back between
/// two stages ends at it instead.
class Kinks {
 public:
  virtual ~Kinks() = default;
  /// Count of the functions.
  [[nodiscard]] virtual std::size_t kinks() const = 0;
  /// Sets them at a state, finite.
  virtual void kinks(std::span<const double> positions, std::span<const double> speeds,
                     std::span<double> values) const noexcept = 0;
};

}  // namespace withy
