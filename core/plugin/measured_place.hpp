/// \file
/// Where a flexible body is looked at for how far it bends.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/body.hpp"

namespace withy {

/// A place of a body, to hold its deflection against the body's length.
struct MeasuredPlace {
  std::string name;  ///< of the station; "at_50" at 50 % of the length where none has a name there
  PointExpansion at;
  /// "the tip", "station 'left'", "the section at 50 % of the length".
  [[nodiscard]] std::string in_words() const;
};

/// The body's measured station; or where that hardly gives, as the tip of a beam whose functions hold both ends, of the
/// stations at every twentieth of its length the one that gives most. Nothing of a body that has no such station.
std::optional<MeasuredPlace> measured_place(const Body& body);
/// The same with what the body has measured beside it (Body::measured_beside): how far it bends is the greatest of all.
std::vector<MeasuredPlace> measured_places(const Body& body);

}  // namespace withy
