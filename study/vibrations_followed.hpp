/// \file
/// Whether steps that nobody controls follow what vibrates in a run.
#pragma once

#include <optional>

#include "withy/core/plugin/equations.hpp"
#include "withy/study/indicators.hpp"

namespace withy::study {

/// Mean step times the frequency above which a tenth of the kinetic energy of vibration is, over states along the run:
/// vibrations of the tree's mass matrix and the bodies' stiffness there, as carried and loaded. One that does not ring
/// but follows a slower force, which an implicit integrator is for, counts with the frequency of that motion: what its
/// accelerations are to its rates. The lowest frequency of a body tells nothing of a run in which a higher mode moves:
/// energy stays in balance, an implicit integrator is stable, and after some steps the phase is any. Nothing where the
/// integrator controls its error, little vibrates or the model is too large to be looked at.
std::optional<Indicator> vibrations_followed(const Scene& scene, const EquationsOfMotion& equations,
                                             const RunSummary& summary);

}  // namespace withy::study
