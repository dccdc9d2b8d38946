/// \file
/// The modes of a scene in several formulations, each against the next model up.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/against_next.hpp"

namespace withy::study {

struct ModesQuestion {
  std::vector<std::string> formulations;  ///< empty: the scene's
  Sweep sweep;                            ///< may be none: one configuration
  Holding holding;
  StartState start;  ///< empty: a scene's initial state
  TurningWish wish;
  bool as_is = false;        ///< about the state as it is given, steady or not
  std::size_t compared = 6;  ///< lowest frequencies that are set against the next model up, at one configuration
};

struct ModesFound {
  std::vector<ModesOf> runs;                        ///< one a formulation
  std::vector<std::optional<AgainstNext>> against;  ///< of each; none along a sweep
  bool interrupted = false;
};

/// \param control of the study of a formulation
/// \throws SceneError, InputError, PluginError
ModesFound find_modes(const Prepared& base, Registry& registry, const ModesQuestion& question,
                      const std::function<Control(const std::string& formulation)>& control);

/// Whether a sweep of a hinge's rate stands still at this value, and a turn that was asked for is none.
bool stands_still(const ModesAt& at, const Sweep& sweep);

/// Where there are no modes, exponents or blades, and why: a sentence each. That a sweep begins where nothing turns
/// is none.
std::vector<std::string> modes_problems(const std::vector<ModesOf>& runs, const Sweep& sweep);

}  // namespace withy::study
