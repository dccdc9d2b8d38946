/// \file
/// Damping found for the modes of the mounted tree, as JSON and as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/mounted_damping.hpp"

namespace withy {

/// `modes` with `hertz`, `asked`, `reached`; `set`, the values of the scene that do it.
nlohmann::ordered_json mounted_damping_json(const study::MountedDamping& damping);
/// A row a mode, then the lines of the scene.
std::string mounted_damping_text(const study::MountedDamping& damping);

}  // namespace withy
