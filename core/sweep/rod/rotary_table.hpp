/// \file
/// Rotary inertia of a flexible body's sections, four sections at a time.
#pragma once

#include <vector>

#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

/// The sections that have rotary inertia, with the fields of their rotation R = exp(θ̂), θ = Ψq + ½qᵀΘq. Sections
/// beyond the last have no inertia.
template <class Space>
struct RotaryTable {
  /// Inertia J [kg m²] about a unit vector e of each section's axes. A section's tensor is the sum over its principal
  /// axes; in the plane the only axis is the normal.
  struct Axis {
    typename Space::Group J, e[3];
  };

  std::size_t sections = 0, packs = 0;
  bool second_order = false;  ///< some Θ is there
  std::size_t axes_each = 0;  ///< axes of each pack, the greatest number that one of its sections has
  SharedNumbers<Axis> axes;
  /// For each pack: Ψ_i (n·angular), then, of second order, Θ_ij for i ≤ j (pairs·angular), components innermost.
  SharedNumbers<typename Space::Group> fields;
  std::size_t stride = 0;  ///< packs of `fields` for each pack of sections

  RotaryTable() = default;
  explicit RotaryTable(const NodeSpec& node);
};

}  // namespace withy::sweep
