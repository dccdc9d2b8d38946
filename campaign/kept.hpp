/// \file
/// What is kept of a case: numbers at its end and greatest numbers along it.
#pragma once

#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/core/simulation/output_statistics.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::campaign {

/// Empty where a name is of a hinge, a column of `results.csv` or a group of them; else what is wrong, with the
/// nearest.
/// \param at_end of `final`, where it may be what a number of an output has been over the run as well: `root_m.mz.max`
/// (`min`, `max`, `mean`, `rms`, `integral`)
std::string kept_problem(const study::Prepared& prepared, const std::string& name, bool at_end);

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
  /// Names of the outputs of which statistics are kept: a StatisticsWatch is to find them.
  [[nodiscard]] const std::vector<std::string>& watched() const { return watched_; }
  /// Of a run that is over, in the order of kept_columns. \param statistics of `watched`
  [[nodiscard]] std::vector<double> numbers(const RunSummary& summary, const std::vector<OutputStatistics>& statistics);

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
  /// A number at the end.
  struct Final {
    std::size_t at, column;
  };
  std::vector<Final> final_;
  std::vector<Peak> peaks_;
  std::vector<Deflection> deflections_;
  /// What a number of an output has been over the run.
  struct Statistic {
    std::size_t at;            ///< among the numbers
    std::string number, what;  ///< "root_m.mz", "max"
  };
  std::vector<Statistic> statistics_;
  std::vector<std::string> watched_;
  std::vector<double> numbers_;
  std::size_t rung_ = 0;  ///< of the last state that was seen
};

}  // namespace withy::campaign
