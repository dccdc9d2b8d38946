/// \file
/// The modes of a scene in several formulations, each against the next model up.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/against_next.hpp"
#include "withy/study/effective_mass.hpp"
#include "withy/study/mounted_damping.hpp"

namespace withy::study {

struct ModesQuestion {
  std::vector<std::string> formulations;  ///< empty: the scene's
  Sweep sweep;                            ///< may be none: one configuration
  Holding holding;
  StartState start;  ///< empty: a scene's initial state
  TurningWish wish;
  bool as_is = false;  ///< about the state as it is given, steady or not
  /// Lowest frequencies that are set against the next model up, at one configuration; 0: none.
  std::size_t compared = 6;
  bool masses = false;       ///< effective masses are found, of one configuration in the scene's formulation
  std::vector<double> damp;  ///< ratios that its lowest vibrations shall have; empty: no damping is found
};
/// Effective masses and damping are of one configuration. \throws OptionError where a sweep or formulations go with
/// them
void check_question(const ModesQuestion& question);

struct ModesFound {
  std::vector<ModesOf> runs;                        ///< one a formulation
  std::vector<std::optional<AgainstNext>> against;  ///< of each; none along a sweep
  /// Of a sweep the values that were done are there, of formulations that were not begun nothing; else nothing is.
  bool interrupted = false;
  std::optional<EffectiveMasses> masses;  ///< none where nobody asked or there are no modes
  std::optional<MountedDamping> damping;  ///< the same
};

/// \param control of the study of a formulation
/// \throws SceneError, InputError, PluginError; std::domain_error as effective_masses and mounted_damping
ModesFound find_modes(const Prepared& base, Registry& registry, const ModesQuestion& question,
                      const std::function<Control(const std::string& formulation)>& control);

/// Whether a sweep of a hinge's rate stands still at this value, and a turn that was asked for is none.
bool stands_still(const ModesAt& at, const Sweep& sweep);

/// Where there are no modes, exponents or blades, and why: a sentence each. That a sweep begins where nothing turns
/// is none.
std::vector<std::string> modes_problems(const std::vector<ModesOf>& runs, const Sweep& sweep);

}  // namespace withy::study
