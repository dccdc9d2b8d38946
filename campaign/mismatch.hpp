/// \file
/// How far runs of a scene are from measured data, as a function of the values that are tuned.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/identified.hpp"
#include "withy/campaign/matched_run.hpp"
#include "withy/campaign/tune.hpp"

namespace withy::campaign {

/// Residuals of a scene as a function of the coordinates z of all tuned values. Counts the runs it makes.
class Mismatch {
 public:
  /// Scene, registry and question must outlive it.
  Mismatch(const study::Prepared& scene, Registry& registry, const TuneQuestion& question,
           std::vector<TunedValue> tuned, Measured data);

  [[nodiscard]] bool stopped() const { return control_.stop(); }
  [[nodiscard]] std::vector<double> values(const Eigen::VectorXd& z) const;
  /// Runs at these points, side by side; the nearest to the data is kept.
  std::vector<MatchedRun> run(const std::vector<Eigen::VectorXd>& points);
  /// The same with values that are no point's.
  std::vector<MatchedRun> run_with(const std::vector<std::vector<double>>& points);
  /// The run at z. Columns without a given deviation that rounding alone changes there by more than derivatives bear
  /// are left out of it and of the data. \param rounding gets their names, in their order
  MatchedRun begin(const Eigen::VectorXd& z, std::vector<std::string>& rounding);
  /// Weighted residuals of a run where something was measured, column by column.
  [[nodiscard]] Eigen::VectorXd residuals(const MatchedRun& run) const;
  /// Those of the run at z; false where there is none.
  bool evaluate(const Eigen::VectorXd& z, Eigen::VectorXd& r);
  /// Their derivatives by some of the coordinates, by central differences; at a bound, or beside a run that fails,
  /// one-sided ones. False where there are none.
  bool derivatives(const Eigen::VectorXd& z, const std::vector<std::size_t>& of, Eigen::MatrixXd& J) {
    return derivatives(z, of, step_, J);
  }
  /// The same extrapolated from two steps, whose difference tells the error.
  bool sensitivity(const Eigen::VectorXd& z, const std::vector<std::size_t>& of, Sensitivity& s);

  const std::vector<TunedValue> tuned;
  Measured data;
  std::size_t runs = 0, failed = 0;
  std::string last_failure;
  /// What was nearest to the data of all that begin() and run() made; empty where none of its runs came to an end.
  std::optional<NearestRun> nearest;

 private:
  bool derivatives(const Eigen::VectorXd& z, const std::vector<std::size_t>& of, double step, Eigen::MatrixXd& J);
  void keep_nearest(const Eigen::VectorXd& z, const MatchedRun& run);
  [[nodiscard]] Eigen::VectorXd moved(Eigen::VectorXd z, std::size_t i, double by) const;
  [[nodiscard]] std::vector<std::string> settings(const Eigen::VectorXd& z) const;

  const study::Prepared& scene_;
  Registry& registry_;
  study::Control control_;
  std::size_t jobs_;
  double step_;
};

/// Root of the mean of the squares.
double root_mean_square(const Eigen::VectorXd& r);

/// How far two runs are from each column: of the scene as it is, which may have failed, and of the fitted one.
std::vector<ColumnFit> column_fits(const Measured& data, const MatchedRun& start, const MatchedRun& end);

}  // namespace withy::campaign
