/// \file
/// One pass over one node, with the number of modes known to the compiler where it is small.
#pragma once

#include <type_traits>

namespace withy::sweep {

/// The most modes that are known to the compiler, 2 to 4: fewer take less time to compile (core/CMakeLists.txt).
#ifdef WITHY_MODES_KNOWN
constexpr int modes_known = WITHY_MODES_KNOWN;
#else
constexpr int modes_known = 4;
#endif

/// Calls action(std::integral_constant<int, n>) for 0 to `modes_known` modes, and with −1 beyond.
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
      if constexpr (modes_known >= 3) return action(std::integral_constant<int, 3>{});
      break;
    case 4:
      if constexpr (modes_known >= 4) return action(std::integral_constant<int, 4>{});
      break;
    default:
      break;
  }
  action(std::integral_constant<int, -1>{});
}

}  // namespace withy::sweep
