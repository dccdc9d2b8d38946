/// \file
/// Flexible bodies that are held where their modes move, or at a root that their modes turn.
#pragma once

#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy::study {

/// Remarks on bodies whose modes leave an edge or some nodes at the root at rest, and which are held elsewhere; and on
/// beams, whose sections are as good as their root, where their functions bend badly when clamped there, as those of a
/// pin do at a welded root: they vibrate notably faster than with as many functions that say nothing of the tip.
/// \throws PluginError where a library that functions are made by is refused.
void look_at_held_places(const Prepared& prepared, Registry& registry, std::vector<Remark>& all);

}  // namespace withy::study
