/// \file
/// The loop that a load closes, opened.
#pragma once

#include <string>

#include "withy/study/linear_model.hpp"

namespace withy::study {

/// The loop of a load that feeds states back, opened at its effort on a hinge: v takes the place of that effort, and y
/// is what the load answers, with the opposite sign, so that v = −y closes the loop as it is in the scene. A sampled
/// load that acts through continuous ones alone, as an actuator or the drive of a wheel, is opened at its command,
/// which they measure. \param load name of the load, or `load.hinge` where it acts on several speeds \throws
/// InputError, std::domain_error
LinearModel open_loop(const Configuration& configuration, const std::string& load);

/// Whether `name` is that of a load, or `load.hinge`, that feeds states back.
bool feeds_back(const Model& model, const std::string& name);

}  // namespace withy::study
