/// \file
/// Fields of modes at a section, compared.
#pragma once

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// Whether any mode moves or turns the section, in first or second order.
inline bool moved_by_modes(const PointExpansion& e) {
  bool moved = !e.phi.isZero(0) || !e.psi.isZero(0);
  for (std::size_t c = 0; c < 3; ++c) moved = moved || !e.gamma[c].isZero(0) || !e.theta[c].isZero(0);
  return moved;
}

/// Whether both are at one place with the same fields, to the bit. Those of one body: they have as many modes.
inline bool same_section(const PointExpansion& a, const PointExpansion& b) {
  bool same = a.X == b.X && a.phi == b.phi && a.psi == b.psi;
  for (std::size_t c = 0; c < 3; ++c) same = same && a.gamma[c] == b.gamma[c] && a.theta[c] == b.theta[c];
  return same;
}

}  // namespace withy
