/// \file
/// How the levels of a reference are integrated: what costs least and adds next to nothing.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/reference.hpp"

namespace withy::study {

/// An integration of levels, at the tolerance at which it adds little to the coarsest.
struct LevelIntegration {
  std::string integrator;
  double tolerance = 0;
  Distances added;                         ///< between this tolerance and a digit less
  std::map<int, double> evaluations = {};  ///< of its runs, by modes
  int measured_at = 0;                     ///< modes of the level that told what is `added`
  /// Evaluations that a level with so many modes takes: as they have grown like a power of the modes over its last two
  /// runs with no more. What a motion asks for goes on with it, whether accuracy or stability limits the steps: it is
  /// told by runs of that integrator alone.
  [[nodiscard]] double expected(int modes) const;
};

/// What an integration is measured with.
struct IntegrationSearch {
  const Outputs& outputs;  ///< must outlive it
  /// A run with a tolerance; nothing where it does not end.
  std::function<std::optional<Reference>(double)> run;
  /// Whether integration may add what is the run's `own`.
  std::function<bool(const Reference&)> little;
  double loosest = 1e-3, tightest = 1e-9;  ///< tolerances; powers of ten between them are looked at
};

/// The loosest tolerance at which a digit less changes little; nothing where none does.
std::optional<LevelIntegration> loosest_integration(const IntegrationSearch& search);

/// The one that is expected to cost least with so many modes. Of `dop853` what its stability asks counts at least; one
/// that solves equations of its own, as `radau`, takes the place of others where it takes less than half as many
/// evaluations.
/// \param integrations at least one
const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations,
                                      int modes);

}  // namespace withy::study
