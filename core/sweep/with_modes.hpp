/// \file
/// One pass over one node, with the number of modes known to the compiler where it is small.
#pragma once

#include <type_traits>

namespace withy::sweep {

/// Calls action(std::integral_constant<int, n>) for 0 to 4 modes, and with −1 beyond.
template <class Action>
inline void with_modes(int modes, Action&& action) {
  switch (modes) {
    case 0:
      return action(std::integral_constant<int, 0>{});
    case 1:
      return action(std::integral_constant<int, 1>{});
    case 2:
      return action(std::integral_constant<int, 2>{});
    case 3:
      return action(std::integral_constant<int, 3>{});
    case 4:
      return action(std::integral_constant<int, 4>{});
    default:
      return action(std::integral_constant<int, -1>{});
  }
}

}  // namespace withy::sweep
