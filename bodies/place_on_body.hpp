/// \file
/// Coordinates that scenes give on bodies.
#pragma once

#include <algorithm>
#include <optional>

namespace withy {

/// A coordinate [m] on a body that reaches from `from` to `to` [m]. Lengths in other units than metres differ in the
/// last bits: what is beyond an end by at most 1e-9 of the body's length is at that end.
/// \returns nothing for what is farther out, or no number
inline std::optional<double> place_on_body(double x, double from, double to) {
  const double rounding = 1e-9 * (to - from);
  if (!(x >= from - rounding && x <= to + rounding)) return {};
  return std::clamp(x, from, to);
}

}  // namespace withy
