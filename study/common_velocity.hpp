/// \file
/// What a velocity that all of a tree has in common does to accelerations: nothing, but in `symmetric`.
#pragma once

#include <optional>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// The greatest part of the accelerations that comes of the velocity of a floating root and of no law of nature, at the
/// end of a run and at some states on its way: ‖(a(y) − a(y₀)) − (b(y) − b(y₀))‖ over ‖a(y)‖, with a the accelerations
/// of the scene's equations, b those of the model up, y₀ the state without that velocity, and ‖a‖² = aᵀ M a of the
/// model up without what all have in common, as the fall of an orbit. What loads and fields make of a velocity is in
/// both differences. The kinetic energy to first order is not that of a frame that moves along (theory, the symmetric
/// first order); of the other formulations there is nothing to be told, nor of trees whose root cannot go anywhere.
/// \param beyond the model up; null: there is none
std::optional<double> part_of_common_velocity(const Prepared& prepared, const Beyond* beyond,
                                              const RunSummary& summary);

}  // namespace withy::study
