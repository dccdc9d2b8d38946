/// \file
/// Bending functions that carry no moment at the tip of a beam, where other bodies hang.
#pragma once

#include <vector>

#include "withy/study/plausibility.hpp"

namespace withy::study {

/// Remarks on flexible bodies whose `clamped-free` bending deflects otherwise, under the weight of what they carry,
/// than it does in more functions with a moment at the tip, where as many of these, and two at least, come nearer. Of
/// the first twenty bodies that carry something. \throws PluginError where a library that functions are made by is
/// refused.
void look_at_tip_moments(const Prepared& prepared, Registry& registry, std::vector<Remark>& all);

}  // namespace withy::study
