/// \file
/// What is kept of a case: numbers at its end and greatest numbers along it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/core/simulation/output_statistics.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::campaign {

/// The output that tells what a hinge's rate has been over a run: "shoulder.motion" of "shoulder.rate.max", and of
/// "base.wx.rms" "base.motion". Nothing for other names.
/// \param scene its values as they were written
std::optional<std::string> output_of_rate(const Value& scene, const std::string& name);

/// Empty where a name is of a hinge, a column of `results.csv` or a group of them; else what is wrong, with the
/// nearest.
/// \param at_end of `final`, where it may be what a number of an output has been over the run as well: `root_m.mz.max`
/// (`min`, `max`, `mean`, `rms`, `integral`), or a rate of a hinge whose output is there
std::string kept_problem(const study::Prepared& prepared, const std::string& name, bool at_end);

/// Columns of the table for what a plan keeps: `final.shoulder[rad]`, `peak.link1.tip.deflection_y[m]`.
std::vector<std::string> kept_columns(const Plan& plan);
/// Names of what it keeps over time: `shoulder[rad]`.
std::vector<std::string> history_columns(const Plan& plan);

/// Where what a plan keeps stands among the columns of a model's results.
struct KeptPlaces {
  /// A number at the end, or the greatest size of one along the run.
  struct Number {
    std::size_t at;  ///< among the kept numbers
    std::size_t column;
  };
  /// A peak that the run's monitor finds.
  struct Deflection {
    std::size_t at;
    std::string body;
    std::size_t axis;
  };
  /// What a number of an output has been over the run.
  struct Statistic {
    std::size_t at;
    std::string number, what;  ///< "root_m.mz", "max"
  };
  std::size_t count = 0;  ///< of the kept numbers
  std::vector<Number> final, peaks;
  std::vector<Deflection> deflections;
  std::vector<Statistic> statistics;
  std::vector<std::string> watched;  ///< names of the outputs of which statistics are kept
  std::vector<std::size_t> histories;
};
/// \param columns of this model's results \throws InputError where it lacks one that the plan's scene has.
KeptPlaces kept_places(const Plan& plan, const study::Prepared& prepared, const std::vector<Column>& columns);
/// Those of the plan's own scene.
KeptPlaces kept_places(const Plan& plan);

/// Takes the kept numbers of one run.
class KeptNumbers {
 public:
  /// The plan and the model must outlive it. \throws InputError where this model lacks a column that the plan's scene
  /// has.
  /// \param of_base kept_places of the plan, taken where this model has the same columns
  KeptNumbers(const Plan& plan, const study::Prepared& prepared, const KeptPlaces& of_base);
  /// Every accepted step, with the rung of `auto`, else 0.
  void see(const State& state, std::size_t rung);
  /// Every output.
  void see_output(const State& state, std::size_t rung);
  /// Whether a peak is not found by the engine's own monitor, so that steps have to be seen.
  [[nodiscard]] bool watches_steps() const { return !places_.peaks.empty(); }
  /// Names of the outputs of which statistics are kept: a StatisticsWatch is to find them.
  [[nodiscard]] const std::vector<std::string>& watched() const { return places_.watched; }
  /// Of a run that is over, in the order of kept_columns. \param statistics of `watched`
  [[nodiscard]] std::vector<double> numbers(const RunSummary& summary, const std::vector<OutputStatistics>& statistics);
  /// Of a run that is over: what is kept over time, as Histories has it.
  [[nodiscard]] std::vector<double> histories() const { return histories_.numbers(); }

 private:
  std::vector<ResultColumns> columns_;  ///< one a rung
  KeptPlaces places_;
  Histories histories_;
  std::vector<double> numbers_;
  std::size_t rung_ = 0;  ///< of the last state that was seen
};

}  // namespace withy::campaign
