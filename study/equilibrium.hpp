/// \file
/// The state that a scene stays in, at rest or spinning steadily, and what can be said of it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/study/against_next.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/stability.hpp"

namespace withy::study {

struct Equilibrium {
  SteadyState steady;
  std::string problem;                 ///< why there is none; empty where there is
  bool stays = false;                  ///< as the hinges turn
  std::string changing;                ///< why it does not stay, and what to do; empty where it does
  std::vector<std::string> passing;    ///< hinges that nothing holds at the rates they have: an instant of a motion
  std::optional<Stability> stability;  ///< none where nothing is free to move, or the state is none that stays
  bool instant = false;                ///< of a motion of such hinges, of a prescribed one or a load that changes
  std::string derivatives;             ///< how they were found
  std::vector<std::pair<std::string, std::array<double, 3>>> deflections;  ///< of flexible bodies' tips [m]
  std::string bent;                    ///< by how much and by what, where that is far; else empty
  std::vector<std::string> limited;    ///< loads that are at their limits there
  std::optional<AgainstNext> against;  ///< of these, in the next model up
};

/// \throws SceneError, PluginError
Equilibrium find_equilibrium(const Configuration& configuration, const Holding& holding, Registry& registry);

}  // namespace withy::study
