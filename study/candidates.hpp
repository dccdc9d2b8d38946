/// \file
/// What advice chooses from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/study/point.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// Values of each axis as asked for, and as they make sense for the scene: formulations cost less before more, modes
/// fewer before more (0 where no body has a number of them), tolerances loosest first.
struct Candidates : Axes {
  std::vector<int> more_modes;  ///< tried where none of `modes` will do; empty where the user says which
  std::vector<int> most_modes;  ///< tried where none of these will do either
};

/// What is chosen from where nothing else is asked; no modes: 1 to 4, and to 8 where these will not do; no
/// formulations: those that take part in studies; no integrators: `dopri5`, `dop853`, and `imex`, `radau` and `cvode`
/// where they are installed.
Axes usual_axes();

/// Those of a trade where nothing else is asked: formulations that take part in studies, the scene's families, 1 to 3
/// modes where bodies can have others, `dopri5` and `imex` at 1e-4 and 1e-6. \throws InputError as check_axes()
Axes trade_axes(Axes asked, const Scene& scene, Registry& registry);

/// The axes without what means nothing for the scene, families of bending added where they mean the same beams.
/// \param asked no families: the scene's, and another where it means the same beams
/// \throws InputError where a value cannot be, or is `inconsistent`.
Candidates candidates_for(const Prepared& prepared, Registry& registry, Axes asked);

/// Families of modes that a reference is made of; see ReferenceGoal. Empty names are the scene's own.
struct ReferenceFamilies {
  std::string first;
  std::vector<std::string> others;  ///< that may do better
};

/// Where they mean the same beams polynomials, or where a tip carries something its static shapes: eigenfunctions of
/// the bare beam begin well and go on badly there. Those that know the load may do better, and where beams vary those
/// that know how; elsewhere all others.
ReferenceFamilies reference_families(const Candidates& candidates, const Prepared& prepared);

/// Names of the scene's bodies that have modes, in its order; a beam in segments is one.
std::vector<std::string> flexible_bodies(const Scene& scene);

/// \throws InputError where a scene's run ends where it begins: no error shows, and everything would hold any accuracy.
void require_a_run(const Scene& scene);

}  // namespace withy::study
