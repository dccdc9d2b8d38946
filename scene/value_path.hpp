/// \file
/// Paths in values, as "bodies.hub.mass" or "gravity.1".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace withy {

class Value;

/// The keys of a path, which dots are between.
std::vector<std::string> keys_of_path(std::string_view path);

/// The value at a path, by members of maps and items of lists; null where there is none.
const Value* value_at(const Value& whole, std::string_view path);

}  // namespace withy
