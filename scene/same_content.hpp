/// \file
/// What values say, wherever they stand.
#pragma once

#include <string>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// Whether two values say the same: kinds, numbers bit by bit, texts, items in their order, members in any. Places do
/// not count.
bool same_content(const Value& a, const Value& b);

/// Appends what a value says: texts are equal where values are, to the last bit, with members in one order.
void append_content(std::string& text, const Value& value);

}  // namespace withy
