/// \file
/// Values of grids and lists in SI units.
#pragma once

#include "withy/campaign/trials.hpp"

namespace withy::campaign {

/// Turns levels that are quantities, as "2000 g", into numbers in SI units where the scene takes numbers. Names that
/// look like quantities stay names, and what has another unit than the first quantity that makes a scene, with the rest
/// of its row, stays as it is: the scene is to refuse it in its own words.
/// \param base the scene without what varies \param tried what came of the plan's trials in it
void use_si(Plan& plan, const SceneValues& base, const Tried& tried, Registry& registry);

}  // namespace withy::campaign
