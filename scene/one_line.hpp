/// \file
/// Values as a scene's file has them.
#pragma once

#include <string>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// A value in one line of YAML, which is read back as the same: numbers with the digits that give them back, texts in
/// quotes where they would else be read as something else.
std::string in_one_line(const Value& value);

}  // namespace withy
