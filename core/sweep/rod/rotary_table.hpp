/// \file
/// Rotary inertia of a flexible body's sections, four sections at a time.
#pragma once

#include <vector>

#include "withy/core/sweep/mass_table.hpp"

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

  TableFrame<Space> frame;
  std::size_t sections = 0, packs = 0;
  std::vector<FieldRun> runs;  ///< of Θ, by component and then by row: all that are not zero
  std::size_t axes_each = 0;   ///< axes of each pack, the greatest number that one of its sections has
  SharedNumbers<Axis> axes;
  /// For each pack: Ψ_i (n·angular), components innermost, then the Θ_ij of `runs`.
  SharedNumbers<typename Space::Group> fields;
  std::size_t stride = 0;  ///< packs of `fields` for each pack of sections

  RotaryTable() = default;
  explicit RotaryTable(const NodeSpec& node);
};

/// Packs of scratch that the terms of `packs` packs of sections of a body need; see add_rotary.
constexpr int rotary_scratch(int packs, int modes) { return (3 + 2 * modes) * packs; }

/// Groups of scratch that `collect_sections` needs.
template <class Space>
std::size_t section_scratch(const RotaryTable<Space>& table, std::size_t modes) {
  if constexpr (Space::angular == 1) return (1 + 2 * modes) * table.packs;
  const int packs = static_cast<int>(table.packs), n = static_cast<int>(modes);
  return static_cast<std::size_t>((6 + 3 * n) * packs + rotary_scratch(packs, n)) + 3 * table.axes_each * table.packs;
}

}  // namespace withy::sweep
