/// \file
/// Hinge coordinates over time from a table, as motions of a scene.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy::app {

/// Coordinates of hinges at the same times.
struct RecordedMotion {
  std::vector<double> times;                               ///< [s], increasing, from 0
  std::map<std::string, std::vector<double>> coordinates;  ///< by hinge [rad, m]
};

/// Reads a CSV file with the head `t[s],shoulder[rad],elbow[deg],…`: as many hinges of one coordinate as it names, in
/// any unit that measures them. Other columns are left out, so that results.csv of a run is such a file. \throws
/// InputError with file and line.
RecordedMotion read_recorded_motion(const std::filesystem::path& file, const Model& model);

/// `path=value` texts with which a scene's motions are these, through the rows by cubic splines, and it ends with the
/// last. Rates in the first row, and what lies a step beyond the last, are those of the cubic through the four rows
/// next to it: accelerations are right to second order in the step up to the ends.
std::vector<std::string> motion_overrides(const RecordedMotion& motion);

}  // namespace withy::app
