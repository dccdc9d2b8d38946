/// \file
/// Modes in words: tables at one configuration or along a sweep.
#pragma once

#include <string>

#include "withy/study/modes.hpp"

namespace withy::app {

/// Frequencies, damping, growth and shapes of one configuration.
std::string modes_text(const study::ModesOf& run, std::size_t count);
/// A row a value, a column a branch; unstable ones marked.
std::string sweep_text(const study::ModesOf& run, const std::string& label, std::size_t count);

}  // namespace withy::app
