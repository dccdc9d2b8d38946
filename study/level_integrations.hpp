/// \file
/// The integrations that are measured for the levels of a reference, and which of them a level has.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/loosest_integration.hpp"

namespace withy::study {

/// What levels may be integrated with, as the coarsest has shown and each level since; nothing until it is measured:
/// levels are then integrated as the goal says.
class LevelIntegrations {
 public:
  /// A run of a point, made once, that may cost so much CPU time [s]; nothing where it does not end.
  using Run = std::function<std::optional<Reference>(const Point&, double seconds)>;

  /// All must outlive it.
  LevelIntegrations(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry,
                    const Outputs& outputs, const ReferenceGoal& goal)
      : model_at_(model_at), registry_(registry), outputs_(outputs), goal_(goal) {}

  /// Finds at which tolerance each integrator adds as little to a level as it may: by the coarsest, in the lowest rung
  /// that truncates nothing. Ends where the user does.
  void measure(const Run& run, const std::function<bool()>& stopped);
  /// The point with the integration that costs least of those measured. Fast modes that limit explicit steps ring at a
  /// loose tolerance, the more the more modes there are; implicit steps damp them.
  [[nodiscard]] Point on(Point point) const;
  /// Notes what a run took: those with more modes are expected to go on so.
  void note(const Reference& run);
  /// What a run costs whose evaluations are as many as those of its integration have grown to [s]; infinite where none
  /// of it is known.
  [[nodiscard]] double expected_seconds(const Point& point) const;
  /// What integration may add to a level's outputs, on top of its `own`.
  void add_to(Reference& level) const;
  /// Holds a level that is known well enough against what integration adds to its own modes, which is measured where
  /// these are many more than those it was measured at: fast modes ring at a tolerance that slow ones are content with.
  /// It is put into `own`. Where that is then too much, levels have a digit less from there on, and the run with that,
  /// in the lowest rung, is returned; nothing where it is not, or there is not the time to know.
  std::optional<Reference> confirm(Reference& level, const Run& run,
                                   const std::function<bool(const Reference&)>& enough);

 private:
  void measure(const std::string& integrator, const Run& run);
  [[nodiscard]] LevelIntegration* of(const Point& point);
  [[nodiscard]] Point coarsest() const;
  [[nodiscard]] double worth(double least) const;
  [[nodiscard]] std::vector<std::string> integrators(const Prepared& prepared) const;

  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const ReferenceGoal& goal_;
  std::vector<LevelIntegration> all_;
  double least_ = 0, least_of_next_ = 0;  ///< CPU time of the coarsest level and the next, with the best so far [s]
};

}  // namespace withy::study
