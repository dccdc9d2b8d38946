/// \file
/// The loop that a load closes, opened.
#pragma once

#include <string>
#include <vector>

#include "withy/study/linear_model.hpp"

namespace withy::study {

/// The loop of a load that feeds states back, opened at its effort on a hinge: v takes the place of that effort, and y
/// is what the load answers, with the opposite sign, so that v = −y closes the loop as it is in the scene. A load
/// that acts through continuous ones alone, as an actuator or the drive of a wheel, is opened at its command, which
/// they measure. \param load name of the load, or `load.hinge` where it acts on several speeds \throws InputError,
/// std::domain_error
LinearModel open_loop(const Configuration& configuration, const std::string& load);

/// Names of the continuous loads whose commands a load follows, at once or by its own states: what it does beside that
/// no gain of theirs scales. \param name as of open_loop
std::vector<std::string> commands_followed(const Configuration& configuration, const std::string& name);

/// Whether `name` is that of a load, or `load.hinge`, that feeds states back.
bool feeds_back(const Model& model, const std::string& name);

}  // namespace withy::study
