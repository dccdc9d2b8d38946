#include "withy/scene/starting_scenes.hpp"

// The files of scenes/new, from starting_scenes.S.
extern "C" const char withy_starting_beam[], withy_starting_satellite[], withy_starting_arm[], withy_starting_turbine[];

namespace withy {

std::span<const StartingScene> starting_scenes() {
  static const StartingScene all[] = {{"beam", withy_starting_beam},
                                      {"satellite", withy_starting_satellite},
                                      {"arm", withy_starting_arm},
                                      {"turbine", withy_starting_turbine}};
  return all;
}

}  // namespace withy
