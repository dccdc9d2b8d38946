/// \file
/// What motors would have to give, as JSON and picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/inverse.hpp"

namespace withy {

/// The demand on each drive.
nlohmann::ordered_json drives_json(const study::InverseStudy& study);
/// Effort over time, a panel a drive.
std::string inverse_picture(const std::string& title, const study::InverseStudy& study);

}  // namespace withy
