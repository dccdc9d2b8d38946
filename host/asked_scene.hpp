/// \file
/// A scene as a study asks for it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/host/scene.hpp"
#include "withy/study/control.hpp"
#include "withy/study/prepared.hpp"

namespace withy::host {

inline study::Control control_of(const Follow& follow) { return {follow.interrupted, follow.progress}; }

/// Made, with those outputs that names say.
std::shared_ptr<const study::Prepared> with_outputs(const Scene& scene, const std::vector<std::string>& names);

}  // namespace withy::host
