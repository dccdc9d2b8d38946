/// \file
/// What in a scene is allowed, yet hardly meant.
#pragma once

#include <string>
#include <vector>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// Something implausible, with its place in the file.
struct Remark {
  Place place;
  std::string text;  ///< what is odd, by which number, and what may have been meant
};

/// The place of a member of a member of the scene, as "hinges" and "axle", or of the scene.
Place place_in_scene(const Scene& scene, const char* group, const std::string& name);

/// In the order of the file: what bodies remark on (damping ratios above 1, strains without modes, what data lack);
/// flexible bodies far shorter than the rest, that carry far more than their own mass, or something with functions that
/// have no moment where it hangs or where they are held, at their root too, or that vary along themselves and have
/// functions of an even beam; servos that drive next to no inertia; motions too fast for the integrator chosen, loads
/// and motions that its steps do not follow; frames and bodies without a use; angles in radians that look like degrees.
/// \throws PluginError where a library that functions are made by is refused.
std::vector<Remark> implausible(const Prepared& prepared, Registry& registry);

}  // namespace withy::study
