/// \file
/// Loads that change with time themselves.
#pragma once

#include <string>
#include <vector>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// Loads whose efforts on what is free are others at other times up to the end of the run with everything as it is: a
/// sine, a table, axes that turn. Nothing that is balanced now stays so.
std::vector<std::string> timed_loads(const Configuration& configuration, const State& state);

}  // namespace withy::study
