/// \file
/// Which family of modes the series of a reference goes on with.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/family_series.hpp"
#include "withy/study/level_steps.hpp"
#include "withy/study/reference_runs.hpp"

namespace withy::study {

/// The families that a reference may have, side by side in the lowest rung that truncates nothing. Which one converges
/// fastest shows late: one whose third mode changes least may go on like 1/n.
class FamilyChoice {
 public:
  /// All must outlive it.
  FamilyChoice(const std::function<const ModelAt&(const Point&)>& model_at, Registry& registry, const Outputs& outputs,
               const ReferenceGoal& goal, ReferenceRuns& runs, const LevelSteps& steps)
      : model_at_(model_at),
        registry_(registry),
        outputs_(outputs),
        goal_(goal),
        runs_(runs),
        steps_(steps),
        series_(outputs, goal.kinds) {}

  /// Chooses the one whose series begins best: whose third mode changes clearly less, and whose evaluations in the
  /// highest rung do not take much longer.
  void begin(const Point& first);
  /// Looks at all again, by how well it is known where the series of each leads to, now and then as modes grow and
  /// where that costs a small part of the time that is left. True where another one than so far is known clearly
  /// better, and was chosen. \param richest of the runs so far: others get as many modes
  bool look(const Reference& richest);
  /// The one that was chosen last.
  [[nodiscard]] const std::string& family() const { return family_; }

  /// A run in the lowest rung, which may cost so much CPU time [s]; nothing where it does not end.
  std::optional<Reference> run(Point point, double seconds = std::numeric_limits<double>::infinity());
  /// Adds one, in the place of that with as many modes.
  void add(const Reference& run) { series_.add(run); }
  /// All such runs.
  [[nodiscard]] const FamilySeries& series() const { return series_; }

 private:
  [[nodiscard]] Point in_lowest(Point point) const;
  [[nodiscard]] bool dear(Point first, const std::string& family);
  [[nodiscard]] std::optional<double> first_change(Point point, const std::string& family);
  [[nodiscard]] std::optional<double> known_in(const std::string& family, Point point);
  [[nodiscard]] bool worth_a_look(const Reference& richest);
  [[nodiscard]] bool may_leave(const std::string& before);

  const std::function<const ModelAt&(const Point&)>& model_at_;
  Registry& registry_;
  const Outputs& outputs_;
  const ReferenceGoal& goal_;
  ReferenceRuns& runs_;
  const LevelSteps& steps_;
  FamilySeries series_;
  std::string family_;
  std::vector<std::string> left_;  ///< families that others took the place of
  std::string coming_back_;        ///< one of these, which the last look has found the best again
  int next_look_ = 4;              ///< modes at which all are looked at again
};

}  // namespace withy::study
