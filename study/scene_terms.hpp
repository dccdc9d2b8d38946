/// \file
/// The terms of motion of a scene at states of it, whatever formulation it is in.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "withy/core/analysis/term_ledger.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// Evaluates them at the accelerations of the scene's own equations.
class SceneTerms {
 public:
  /// `prepared` must outlive it. \throws InputError, std::invalid_argument where the model cannot be compiled in the
  /// formulations that terms are the differences of
  SceneTerms(const Prepared& prepared, Registry& registry);
  /// Of all speeds, until it is asked again; nothing where the equations have none.
  [[nodiscard]] std::optional<std::span<const double>> accelerations(const State& state);
  [[nodiscard]] TermForces forces(const State& state, std::span<const double> accelerations) const {
    return ledger_.evaluate(state, accelerations);
  }
  /// Of each speed, at the scene's start: what forces on different coordinates are measured by.
  [[nodiscard]] const std::vector<double>& inertias() const { return inertias_; }

 private:
  const Prepared& prepared_;
  std::vector<Beyond> compiled_;  ///< what terms are the differences of
  TermLedger ledger_;
  std::vector<double> inertias_, rates_;
  Work work_;
};

}  // namespace withy::study
