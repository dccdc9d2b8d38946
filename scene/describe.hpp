/// \file
/// Values and specifications in words, for messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "withy/core/plugin/parameters.hpp"

namespace withy {

/// What a specification accepts, as "finite > 0 [N m^2]".
std::string expectation(const ParameterSpec& spec);
/// What a value is, for messages: "nan", "\"25 kg\"", "a list of 3".
std::string shown(const Value& value);
/// "hinge", "mode family"; empty for nothing.
const char* referent(ParameterSpec::Refers what);
/// Keys of a map, and of a list of specifications.
std::vector<std::string> keys_of(const Value& map);
std::vector<std::string> keys_of(const std::vector<ParameterSpec>& members);
/// "; did you mean 'length'?" or, where none is near, "; known: length, mass".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);
/// The value and everything in it standing at `place`, with paths from there.
Value placed(Value value, const Place& place);

}  // namespace withy
