/// \file
/// Discrete states of loads, which are constant between instants.
#pragma once

#include <algorithm>
#include <span>

#include "withy/core/plugin/state.hpp"

namespace withy {

/// Sets the discrete states in `y` to those in `from`, both laid out as State::y: what interpolants end with. Some
/// discrete states are numbers of things, as that of which hinges are locked, and (1 − θ) 1 + θ 1 may be a rounding
/// below 1.
inline void keep_discrete_states(const Layout& layout, std::span<const double> from, std::span<double> y) noexcept {
  std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(layout.moving()), layout.discrete,
              y.begin() + static_cast<std::ptrdiff_t>(layout.moving()));
}

}  // namespace withy
