/// \file
/// Bending functions of even beams on beams whose section varies.
#pragma once

#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy::study {

/// Remarks on flexible bodies with a free tip and a property that is a table, which vibrate notably faster by
/// themselves than with as many of the beam's own modes. \throws PluginError where a library that functions are made by
/// is refused.
void look_at_varying_sections(const Prepared& prepared, Registry& registry, std::vector<Remark>& all);

}  // namespace withy::study
