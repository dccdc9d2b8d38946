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
/// A parameter's unit, "rad, or m of what slides" where it is that of what a hinge does.
std::string unit_text(const std::string& unit);
/// What a value is, for messages: "nan", "\"25 kg\"", "a list of 3".
std::string shown(const Value& value);
/// "hinge", "mode family"; empty for nothing.
const char* referent(ParameterSpec::Refers what);
/// Keys of a map, and of a list of specifications.
std::vector<std::string> keys_of(const Value& map);
std::vector<std::string> keys_of(const std::vector<ParameterSpec>& members);
/// "; did you mean 'length'?" or, where none is near, "; known: length, mass".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);
/// "no 'lenght'; did you mean 'length'?", of several names "no 'lenght' (did you mean 'length'?), no 'x'; known: …".
std::string unknown_names(const std::vector<std::string>& names, const std::vector<std::string>& candidates);
/// Of "z" or "-x" where three numbers are needed, as ", as [0, 0, 1]"; empty for all else.
std::string axis_as_list(const Value& value);
/// The plugin of `ids` that is meant by a name: the one of the method that other programs call so, else the nearest;
/// empty where none is near.
std::string known_elsewhere(const std::string& name, const std::vector<std::string>& ids);
/// The value and everything in it standing at `place`, with paths from there.
Value placed(Value value, const Place& place);

}  // namespace withy
