/// \file
/// How the levels of a reference are integrated: what costs least and adds next to nothing.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/reference.hpp"

namespace withy::study {

/// An integration of levels, as it was with the coarsest.
struct LevelIntegration {
  std::string integrator;
  double tolerance = 0;
  Distances added;         ///< between this tolerance and a digit less
  double evaluations = 0;  ///< of the run with this tolerance
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

/// The one that takes the fewest evaluations with more modes: of `dop853` as many as its stability asks at least, of
/// others as many as they took.
/// \param integrations at least one
const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations);

}  // namespace withy::study
