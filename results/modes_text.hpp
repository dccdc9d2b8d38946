/// \file
/// Modes in words: tables at one configuration or along a sweep.
#pragma once

#include <string>

#include "withy/study/formulation_modes.hpp"

namespace withy {

/// Frequencies, damping, growth and shapes of one configuration.
std::string modes_text(const study::ModesOf& run, std::size_t count);
/// All eigenvalues of one configuration, real ones by themselves, in the order of |λ|.
std::string poles_text(const study::ModesAt& at);
/// What a whole turn tells; empty where nobody asked. \param label of the value it is at; may be empty
std::string turning_text(const study::TurningModes& turn, const std::string& label);
/// A row a value, a column a branch; unstable ones marked.
std::string sweep_text(const study::ModesOf& run, const study::Sweep& sweep, std::size_t count);

/// All of it: each formulation with its distance from the next model up, and what a turn says.
/// \param poles all eigenvalues are listed
std::string modes_study_text(const std::string& scene, const study::Sweep& sweep, const study::ModesFound& found,
                             std::size_t count, bool poles);

}  // namespace withy
