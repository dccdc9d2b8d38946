/// \file
/// Fits values of a scene to measured data: nonlinear least squares over whole runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/measured.hpp"
#include "withy/campaign/tuned_values.hpp"
#include "withy/study/control.hpp"

namespace withy::campaign {

struct TuneQuestion {
  std::vector<std::string> parameters;  ///< as read_tuned takes them
  std::string data;                     ///< file
  std::optional<std::string> text;      ///< MeasuredWish::text
  std::vector<std::string> outputs;     ///< MeasuredWish::outputs
  std::vector<std::string> deviations;  ///< MeasuredWish::deviations
  /// Searches: from the scene's values, the others from the best of ten times as many points drawn within the bounds,
  /// or where there are none up to a factor of two away.
  std::size_t starts = 1;
  std::uint64_t seed = 1;
  std::size_t jobs = 0;  ///< runs at once; 0: one a core
  study::Control control;
};

/// What became of a parameter.
struct FittedValue {
  enum class State {
    fitted,
    at_bound,     ///< the least sum of squares lies at the bound or beyond it
    undetermined  ///< the data do not tell it from others; it has the value that the search began with
  };
  TunedValue tuned;
  State state = State::fitted;
  double value = 0;                 ///< in the unit of `tuned`
  std::optional<double> deviation;  ///< standard deviation in that unit; of fitted ones of a search that has converged
  /// Of undetermined ones: parameters whose relative change by the factor has the effect of a relative change of this
  /// one by 1, both of the values found (of one that is 0, of its scale); none: it has no effect on the data.
  std::vector<std::pair<std::size_t, double>> same_as;
};

/// How far a run is from a column of the data.
struct ColumnFit {
  double before = 0, after = 0;       ///< root of the mean square of the residuals, SI; before: of the scene as it is
  std::optional<double> correlation;  ///< of neighbouring residuals after the fit, where they are worth a look
  std::vector<double> at_start, at_end;  ///< the runs' values at the data's times; empty where that run failed
};

/// Where a start of the search came to.
struct SearchEnd {
  std::vector<double> from, to;  ///< values in the units of the parameters
  double residual = 0;           ///< root of the mean square of weighted residuals
  bool converged = false;
  bool agrees = false;  ///< it came to the fitted values
  std::string reason;
};

/// A run on the way of a search.
struct NearestRun {
  std::vector<std::string> settings;  ///< of the parameters, as `--set` takes them: "loads.spring.stiffness=20 N/m"
  double residual = 0;                ///< root of the mean square of weighted residuals
};

struct TuneResult {
  std::vector<FittedValue> parameters;
  std::vector<std::vector<double>> correlation;  ///< of the fitted ones, in their order
  std::vector<double> singular_values;           ///< of the weighted derivatives by the fitted coordinates
  Measured data;
  std::vector<ColumnFit> columns;
  /// Root of the mean square of all weighted residuals; before: of the scene as it is, 0 where that has no run.
  double before = 0, after = 0;
  std::vector<SearchEnd> starts;  ///< the best first
  std::size_t agreeing = 0;       ///< of them that came to the same place
  std::size_t runs = 0, failed = 0;
  std::string last_failure;
  bool interrupted = false;
  std::optional<NearestRun> nearest;  ///< of an interrupted search the best run that had ended
  std::string trouble;                ///< why there is no fit; empty where there is

  [[nodiscard]] bool converged() const { return trouble.empty() && !starts.empty() && starts.front().converged; }
  [[nodiscard]] std::vector<double> values() const;
};

/// Runs what is asked. \throws study::InputError with all that is wrong with parameters and data, a line each;
/// PluginError
TuneResult tune(const study::Prepared& scene, Registry& registry, const TuneQuestion& question);

/// The scene's values changed to the fitted ones; those that the data do not determine stay.
std::vector<study::Change> fitted_changes(const SceneValues& scene, const TuneResult& result);

}  // namespace withy::campaign
