/// \file
/// What is implausible in a valid scene, as JSON and as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy {

/// `scene`, `valid`, and `remarks` with their places in the file, or with the `origin` of what did not come from there.
/// \param origins SceneValues::origins of the scene
nlohmann::ordered_json remarks_json(const Scene& scene, const std::vector<study::Remark>& remarks,
                                    const std::vector<std::string>& origins);
/// A line a remark, in the form of errors; then what the scene is made of. \param origins as above
std::string remarks_text(const Scene& scene, const std::vector<study::Remark>& remarks,
                         const std::vector<std::string>& origins);

}  // namespace withy
