/// \file
/// What is kept of a case: numbers at its end and greatest numbers along it.
#pragma once

#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::campaign {

/// Empty where a name is of a hinge, a column of `results.csv` or a group of them; else what is wrong, with the
/// nearest.
std::string kept_problem(const study::Prepared& prepared, const std::string& name);

/// Columns of the table for what a plan keeps: `final.shoulder[rad]`, `peak.link1.tip.deflection_y[m]`.
std::vector<std::string> kept_columns(const Plan& plan);

/// Takes the kept numbers of one run.
class KeptNumbers {
 public:
  /// The plan and the model must outlive it. \throws InputError where this model lacks a column that the plan's scene
  /// has.
  KeptNumbers(const Plan& plan, const study::Prepared& prepared);
  /// Every accepted step and every output, with the rung of `auto`, else 0.
  void see(const State& state, std::size_t rung);
  /// Whether a peak is not found by the engine's own monitor, so that steps have to be seen.
  [[nodiscard]] bool watches_steps() const { return !peaks_.empty(); }
  /// Of a run that is over, in the order of kept_columns.
  [[nodiscard]] std::vector<double> numbers(const RunSummary& summary);

 private:
  /// A peak that the run's monitor finds.
  struct Deflection {
    std::size_t at;  ///< among the numbers
    std::string body;
    std::size_t axis;
  };
  struct Peak {
    std::size_t at, column;
  };
  std::vector<ResultColumns> columns_;  ///< one a rung
  std::vector<std::size_t> final_;      ///< columns
  std::vector<Peak> peaks_;
  std::vector<Deflection> deflections_;
  std::vector<double> numbers_;
  std::size_t rung_ = 0;  ///< of the last state that was seen
};

}  // namespace withy::campaign
