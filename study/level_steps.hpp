/// \file
/// How many modes the levels of a reference have.
#pragma once

#include <vector>

#include "withy/study/level_integrations.hpp"
#include "withy/study/reference.hpp"

namespace withy::study {

/// The numbers of modes that a series of runs goes through, and which run comes next.
class LevelSteps {
 public:
  /// Both must outlive it.
  LevelSteps(const ReferenceGoal& goal, const LevelIntegrations& integrations)
      : goal_(goal), integrations_(integrations) {}

  /// The level after one; a step as the last one was where a longer one would cost much of the time that is left.
  [[nodiscard]] Point finer(Point point) const;
  /// Half a step before one; itself where the last step was that of a mode.
  [[nodiscard]] Point between(Point point) const;
  /// Whether a run is expected to cost less than half of the time that is left; true where that is not known.
  [[nodiscard]] bool costs_little(const Point& point) const;
  /// Numbers of modes of a series up to one, from half of these on.
  [[nodiscard]] std::vector<int> upper_half(int modes) const;

 private:
  [[nodiscard]] int after(int modes) const;
  [[nodiscard]] int last(int modes) const;

  const ReferenceGoal& goal_;
  const LevelIntegrations& integrations_;
};

}  // namespace withy::study
