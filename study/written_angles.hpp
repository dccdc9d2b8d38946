/// \file
/// Degrees that were written as if a scene counted in them.
#pragma once

#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy::study {

/// Remarks on angles of more than a turn without a unit: of orientations; and where they are whole multiples of five as
/// well, what loads, motions, events and the initial state give of hinges that turn, and phases.
void look_at_written_angles(const Prepared& prepared, Registry& registry, std::vector<Remark>& all);

}  // namespace withy::study
