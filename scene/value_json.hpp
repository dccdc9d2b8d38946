/// \file
/// Values as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// Members in the order of the value.
nlohmann::ordered_json value_json(const Value& value);
/// Appends a member to an object that has none of that name, in constant time.
void append_member(nlohmann::ordered_json& object, std::string key, nlohmann::ordered_json value);

}  // namespace withy
