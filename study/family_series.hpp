/// \file
/// Series of modes side by side: those of one formulation, by the family of their modes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "withy/study/reference.hpp"

namespace withy::study {

/// Runs of one formulation, by the family of their modes and how many these are.
class FamilySeries {
 public:
  /// \param outputs must outlive it
  FamilySeries(const Outputs& outputs, int kinds) : outputs_(outputs), kinds_(kinds) {}

  /// Adds a run, in the place of one with as many modes of the family.
  void add(const Reference& run) { runs_[run.point.family].insert_or_assign(run.point.modes, run); }
  /// The run with most modes of a family; null where there is none.
  [[nodiscard]] const Reference* richest(const std::string& family) const;
  /// Whether there is a run with so many modes of a family.
  [[nodiscard]] bool has(const std::string& family, int modes) const;
  /// Its runs from so many modes on, fewest modes first.
  [[nodiscard]] std::vector<Reference> from(const std::string& family, int modes) const;
  /// Where all of its runs from so many modes on lead to.
  [[nodiscard]] ModeSeries series(const std::string& family, int from = 0) const;

 private:
  const Outputs& outputs_;
  int kinds_;
  std::map<std::string, std::map<int, Reference>> runs_;
};

}  // namespace withy::study
