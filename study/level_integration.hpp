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

/// An integration of levels, as it was with the coarsest.
struct LevelIntegration {
  std::string integrator;
  double tolerance = 0;
  Distances added;         ///< between this tolerance and a digit less
  double evaluations = 0;  ///< of the run with this tolerance
  /// Explicit steps were limited by stability there: of levels that accuracy limits the tolerance says nothing.
  bool at_stability = false;
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

/// How many more evaluations accuracy asks of levels with more modes than of the coarsest, whatever the integrator:
/// faster modes take part in the motion. Runs tell, but where stability limited explicit steps they tell no more than
/// that it is less.
class LevelGrowth {
 public:
  /// \param explicit_evaluations that stability asks of `dop853` at that level
  void note(int modes, const LevelIntegration& with, double evaluations, double explicit_evaluations);
  /// Times the evaluations of the coarsest level, by the runs with the most modes up to these; at least 1.
  [[nodiscard]] double expected(int modes) const;

 private:
  struct Seen {
    double times = 1;
    bool at_most = false;
  };
  std::map<int, Seen> seen_;  ///< by modes
};

/// Whether stability, not accuracy, limits the steps of a run.
bool limited_by_stability(const std::string& integrator, double evaluations, double explicit_evaluations);

/// The one that takes the fewest evaluations with more modes: as many times what it took as levels have grown, of
/// `dop853` what its stability asks at least.
/// \param integrations at least one, \param growth LevelGrowth; counts where the tolerances of all are those that
/// accuracy asked for
const LevelIntegration& cheapest_with(const std::vector<LevelIntegration>& integrations, double explicit_evaluations,
                                      double growth);

}  // namespace withy::study
