/// \file
/// Numbers of several cases, an array each, into lanes and back.
#pragma once

#include <array>
#include <cstddef>

#include "withy/core/spatial/lanes.hpp"

namespace withy {

/// The first numbers of an array a lane. In registers: a load waits for stores of its parts.
template <class Number>
inline void gather(const std::array<Number*, cases_at_once>& from, std::size_t count, Lanes* to) {
  for (std::size_t i = 0; i < count; ++i) {
    if constexpr (cases_at_once == 8) {
      to[i] = Lanes::of(
          LaneNumbers{from[0][i], from[1][i], from[2][i], from[3][i], from[4][i], from[5][i], from[6][i], from[7][i]});
    } else {
      to[i] = Lanes::of(LaneNumbers{from[0][i], from[1][i], from[2][i], from[3][i]});
    }
  }
}
/// Where there is a place for them; null: there is none.
inline void scatter(const Lanes* from, std::size_t count, const std::array<double*, cases_at_once>& to) {
  for (std::size_t lane = 0; lane < cases_at_once; ++lane) {
    if (to[lane] == nullptr) continue;
    for (std::size_t i = 0; i < count; ++i) to[lane][i] = from[i][lane];
  }
}

}  // namespace withy
