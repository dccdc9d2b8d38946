/// \file
/// How far a state that small motions are about is bent.
#pragma once

#include <string>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// Which tip is deflected most, by how much of its body's length and by which loads, where that is more than small: a
/// load that acts for a moment at the state's time is taken for one that stays. Empty where no tip is.
std::string bent_text(const Configuration& configuration, const State& steady);

}  // namespace withy::study
