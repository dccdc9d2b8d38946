/// \file
/// What a linear analysis owes to its formulation: the same found in the next model up.
#pragma once

#include <optional>
#include <string>

#include "withy/study/configuration.hpp"
#include "withy/study/modes.hpp"

namespace withy::study {

struct AgainstNext {
  std::string formulation;  ///< that neglects less
  double most = 0;          ///< greatest relative difference
  std::string of;           ///< where: the coordinate that dominates the mode, the tip
  std::size_t compared = 0;
  std::string problem;  ///< why nothing was compared; empty where it was
};

/// Of the lowest `count` frequencies at one configuration that are not rigid; nothing where no model is above.
/// \throws SceneError, InputError, PluginError as sweep_modes
std::optional<AgainstNext> frequencies_against_next(const ModesOf& run, const SceneValues& values, Registry& registry,
                                                    const StartState& start, const Holding& holding, bool as_is,
                                                    std::size_t count, const Control& control);
/// Of the tips' deflections in a steady state, over the greatest of them.
std::optional<AgainstNext> deflections_against_next(const Configuration& configuration, const SteadyState& steady,
                                                    const Holding& holding, Registry& registry);

/// "Difference from exact in the 6 lowest frequencies: up to 6.2 %, most link.bending_z[1]."; what nothing is known of
/// is said too.
std::string against_next_text(const std::optional<AgainstNext>& against, const std::string& what);

}  // namespace withy::study
