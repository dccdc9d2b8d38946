/// \file
/// Reads the values of a scene that a command goes through: `--over path=value,value,…`, `--sweep path=from:to:count`.
#pragma once

#include <optional>
#include <string>

#include "withy/study/modes.hpp"
#include "withy/study/point.hpp"

namespace withy::app {

/// \throws InputError
study::Variation parse_variation(const std::string& text);
/// Last part of a path: "time_scale".
std::string label_of(const std::string& path);

/// Reads `path=from:to:count`, or `path=from:to` where a count is given here. An empty text gives no sweep with the one
/// value zero.
/// \param option named in messages, as "--sweep".
/// \throws InputError
study::Sweep parse_sweep(const std::string& text, const std::string& option, std::optional<std::size_t> count = {});

}  // namespace withy::app
