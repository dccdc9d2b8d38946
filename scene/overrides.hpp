/// \file
/// Changes to a scene from the command line, before it is checked.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "withy/scene/document.hpp"

namespace withy {

struct SceneOptions;

/// Gives `formulation` and `integrator` their long form, then applies the options to the document. Places of what
/// they bring have the line −1−k, k being the index of its description in the list returned, as
/// "--set 'time.end=2'".
std::vector<std::string> apply_options(Document& document, const SceneOptions& options, Diagnostics& diagnostics);

}  // namespace withy
