/// \file
/// How far the hinges of a model's loops turn from one state to another.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// The angles of the hinges that loops run through, in states of a model. A rotor beside a loop or on a link of it, and
/// what carries all of a loop, leave the closing equations as they are. Immutable.
class HingeAngles {
 public:
  explicit HingeAngles(const Model& model);
  /// The greatest angle by which one turns from one state to the next, `seconds` later [rad]: by its coordinates,
  /// or by its rates at one of the two where these say more, as of a spherical hinge.
  [[nodiscard]] double turned(std::span<const double> before, std::span<const double> after,
                              double seconds) const noexcept;

 private:
  /// Indices in State::y.
  struct Angle {
    std::size_t rate = 0;
    std::optional<std::size_t> position;  ///< none where coordinates are a quaternion
  };
  std::vector<Angle> angles_;
};

}  // namespace withy
