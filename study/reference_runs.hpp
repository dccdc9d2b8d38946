/// \file
/// Runs that a reference is made of: each is made once, and ends where it costs more than it may.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>

#include "withy/study/level_integrations.hpp"
#include "withy/study/reference.hpp"

namespace withy::study {

/// The runs of one search.
class ReferenceRuns {
 public:
  /// All must outlive it.
  ReferenceRuns(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry, const Outputs& outputs,
                const ReferenceGoal& goal, const Control& control);

  /// Finds what levels are to be integrated with, by runs of the coarsest.
  void measure_integrations();
  /// How levels are integrated.
  [[nodiscard]] const LevelIntegrations& integrations() const { return integrations_; }

  /// LevelIntegrations::confirm by runs of this.
  std::optional<Reference> confirm(Reference& level, const std::function<bool(const Reference&)>& enough);

  /// A run, made once; nothing where it does not come to its end.
  std::optional<Reference> at(const Point& point);
  /// The same, where one that is not worth its time is no trouble. \param seconds of CPU time that it may cost
  std::optional<Reference> at(const Point& point, double seconds);
  [[nodiscard]] bool has(const Point& point) const { return runs_.contains(point.key()); }

  /// What has become of the search so far; its runs are taken last.
  ReferenceFound& found() { return found_; }
  [[nodiscard]] const ReferenceFound& found() const { return found_; }
  ReferenceFound take_found();

 private:
  std::optional<Reference> run(const Point& point);
  std::optional<Reference> ended(const Point& point, Reference r);

  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const ReferenceGoal& goal_;
  const Control& control_;
  ReferenceFound found_;
  LevelIntegrations integrations_;
  double most_seconds_ = std::numeric_limits<double>::infinity();  ///< that a run may cost
  std::map<std::string, Reference> runs_;                          ///< that came to their end, by the point's key
};

}  // namespace withy::study
