/// \file
/// Scenes of the gallery as the tests of studies use them.
#pragma once

#include <string>

#include "withy/scene/scene_values.hpp"

namespace withy::study {

/// The scene of this name of the gallery.
inline SceneValues scene(const std::string& name) {
  return SceneValues::read(std::string(WITHY_SOURCES) + "/scenes/" + name + ".yaml");
}

/// The slew until 0.2 s, its torques times `scale`.
inline SceneValues short_slew(double scale = 1.0) {
  SceneValues values = scene("two-link-slew");
  values.set("time.end", Value(0.2), "the test").set("loads.slew.time_scale", Value(scale), "the test");
  return values;
}

}  // namespace withy::study
