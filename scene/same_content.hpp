/// \file
/// What values say, wherever they stand.
#pragma once

#include "withy/core/plugin/value.hpp"

namespace withy {

/// Whether two values say the same: kinds, numbers bit by bit, texts, items in their order, members in any. Places do
/// not count.
bool same_content(const Value& a, const Value& b);

}  // namespace withy
