/// \file
/// Names in a scene that cannot be made, so that what is wrong with them is said together with all else.
#pragma once

#include "withy/scene/check.hpp"

namespace withy {

/// Reports hinges, bodies and loads that events name and the scene has not, in the words of SceneEvents::add_to, which
/// needs a model. What else an event asks for is looked at there.
void check_event_names(const Document& document, const SceneNames& names, const Checker& checker);
/// Reports hinges and bodies that `initial` names and the scene has not, in the words of set_start, which needs a
/// model.
void check_start_names(const Document& document, const SceneNames& names, const Checker& checker);

}  // namespace withy
