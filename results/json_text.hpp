/// \file
/// JSON: as text, and of plugin specifications.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/core/plugin/parameters.hpp"
#include "withy/scene/value_json.hpp"

namespace withy {

/// The text of a result, indented, ending its line. Numbers that are not finite become null.
std::string json_text(const nlohmann::ordered_json& json);
/// The same on one line without an end. Bytes that are no UTF-8, as names of files may have, are replaced.
std::string json_line(const nlohmann::ordered_json& json);
/// A value for people: a text without its quotes, a whole number without its fraction.
std::string plain_text(const nlohmann::ordered_json& value);
/// A plugin's option: key, kind, unit, meaning, whether required, default, limits, choices, members.
nlohmann::ordered_json parameter_json(const ParameterSpec& parameter);

}  // namespace withy
