/// \file
/// Hinge coordinates over time from a table, as motions of a scene.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// Coordinates of hinges at the same times.
struct RecordedMotion {
  std::vector<double> times;                               ///< [s], increasing, from 0
  std::map<std::string, std::vector<double>> coordinates;  ///< by hinge [rad, m]
  std::vector<std::string> ignored;                        ///< heads of columns that no hinge has, as the file has them
};

/// Reads a CSV file with the head `t[s],shoulder[rad],elbow[deg],…`: as many hinges of one coordinate as it names, in
/// any unit that measures them. Other columns are left out and named, so that results.csv of a run is such a file; one
/// whose name is near that of a hinge without a column is an error. \throws InputError with file, line and column.
RecordedMotion read_recorded_motion(const std::filesystem::path& file, const Model& model);
/// The same from its text; `file` stands for it in messages.
RecordedMotion parse_recorded_motion(const std::string& text, const std::string& file, const Model& model);

/// The scene with these motions in the place of its own, through the rows by cubic splines; it ends with the last row.
/// Rates in the first row, and what lies a step beyond the last, are those of the cubic through the four rows next to
/// it: accelerations are right to second order in the step up to the ends.
SceneValues led_by(SceneValues values, const RecordedMotion& motion);

/// A motion that leads a scene, as a study is asked for it.
struct MotionWish {
  std::string file;                 ///< empty, without a text: the scene's own motions
  std::optional<std::string> text;  ///< of the file, which is then not read
};
struct LedScene {
  Prepared prepared;
  std::vector<std::string> ignored;  ///< RecordedMotion::ignored
};
/// \throws InputError, SceneError, PluginError
LedScene led_scene(const Prepared& prepared, const MotionWish& wish, Registry& registry);

}  // namespace withy::study
