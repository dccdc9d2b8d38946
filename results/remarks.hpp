/// \file
/// What is implausible in a valid scene, as JSON and as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy {

/// `scene`, `valid`, and `remarks` with their places in the file.
nlohmann::ordered_json remarks_json(const Scene& scene, const std::vector<study::Remark>& remarks);
/// A line a remark, in the form of errors; then what the scene is made of.
std::string remarks_text(const Scene& scene, const std::vector<study::Remark>& remarks);

}  // namespace withy
