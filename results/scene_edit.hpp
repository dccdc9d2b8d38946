/// \file
/// Changes values in the text of a scene and leaves the rest as it is written, comments too.
#pragma once

#include <string>
#include <vector>

#include "withy/scene/scene_values.hpp"
#include "withy/study/point.hpp"
#include "withy/study/prepared.hpp"

namespace withy {

class Registry;

/// The text with each `path.to.value=text` in it, as `--set` would have it. Values take the place of those that are
/// there; new keys come first in their map. A JSON text stays one.
/// \throws study::InputError where the text cannot be read or a path leads nowhere.
std::string edited(std::string text, const std::vector<std::string>& overrides);

/// Before a study whose findings write_changed is to write: that it will be able to. An older file of that name is
/// replaced, but none that the command reads.
/// \param also another file that the command reads; may be empty
/// \throws study::InputError where the file is read, or the command line changes the scene; SceneError where it cannot
/// be read from the folder of the file
void check_written(const study::Prepared& prepared, const std::string& file, const std::string& also,
                   Registry& registry);

/// Writes the file that a scene was read from, with changes in its text, under another name; an older file of that name
/// is replaced. What the text then reads as has to be the scene of the file with these changes, and a scene: else no
/// file is written. \throws study::InputError as edited, and where the text cannot be changed so; SceneError;
/// std::system_error
void write_changed(const SceneValues& scene, const std::vector<study::Change>& changes, const std::string& file,
                   Registry& registry);

/// Lines of a scene that say the same: maps down to the third level in lines, deeper ones in braces.
std::string scene_lines(const std::vector<std::string>& overrides);

}  // namespace withy
