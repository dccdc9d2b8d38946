/// \file
/// Values of a scene that are gone through, as people write them: `path=value,value,…`, `path=from:to:count`.
#pragma once

#include <optional>
#include <string>

#include "withy/study/modes.hpp"
#include "withy/study/point.hpp"

namespace withy::study {

/// Reads `path=value,value,…`. \throws OptionError of `over`
Variation parse_variation(const std::string& text);
/// Last part of a path: "time_scale".
std::string label_of(const std::string& path);

/// Reads `path=from:to:count`, or `path=from:to` where a count is given here. An empty text gives no sweep with the one
/// value zero.
/// \param option that messages name, as "sweep"
/// \throws OptionError
Sweep parse_sweep(const std::string& text, const std::string& option, std::optional<std::size_t> count = {});

}  // namespace withy::study
