/// \file
/// Changes values in the text of a scene and leaves the rest as it is written, comments too.
#pragma once

#include <string>
#include <vector>

namespace withy {

/// The text with each `path.to.value=text` in it, as `--set` would have it. Values take the place of those that are
/// there; new keys come first in their map. A JSON text stays one.
/// \throws study::InputError where the text cannot be read or a path leads nowhere.
std::string edited(std::string text, const std::vector<std::string>& overrides);

/// Lines of a scene that say the same: maps down to the third level in lines, deeper ones in braces.
std::string scene_lines(const std::vector<std::string>& overrides);

}  // namespace withy
