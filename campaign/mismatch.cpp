#include "withy/campaign/mismatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <thread>

#include "withy/scene/units.hpp"

namespace withy::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Half of the difference in a coordinate that derivatives are taken over: what integration leaves of error at a
/// relative tolerance disturbs them as little as the curvature does.
double difference_step(const Scene& scene) {
  const Value* rtol = scene.source.at("integrator").find("rtol");
  return std::clamp(std::sqrt(rtol == nullptr ? 1e-6 : rtol->number()), 1e-4, 1e-2);
}

/// Neighbouring residuals of a column are correlated where the model lacks something.
std::optional<double> neighbours(const MeasuredColumn& column, const std::vector<double>& run, double rms,
                                 double range) {
  constexpr double least_share = 1e-4, least = 0.3, of_chance = 4;
  double products = 0, squares = 0, before = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (!std::isfinite(column.values[i])) continue;
    const double r = run[i] - column.values[i];
    if (count++ > 0) products += r * before;
    squares += r * r;
    before = r;
  }
  const double correlation = squares > 0 ? products / squares : 0;
  const bool worth =
      rms > least_share * range && correlation > std::max(least, of_chance / std::sqrt(static_cast<double>(count)));
  return worth ? std::optional(correlation) : std::nullopt;
}

/// Whether rounding of a run shows in a tenth of what was measured of a column, so that differences of runs hide what
/// parameters do. An instant that rounding moves past a row changes one row alone.
bool felt_by(const MeasuredColumn& column, const std::vector<double>& run, const std::vector<double>& rounded,
             double least) {
  constexpr std::size_t tenth = 10;
  std::size_t count = 0, differ = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (!std::isfinite(column.values[i])) continue;
    ++count;
    differ += std::abs(run[i] - rounded[i]) > least * column.deviation ? 1 : 0;
  }
  return tenth * differ > count;
}

}  // namespace

double root_mean_square(const VectorXd& r) { return r.norm() / std::sqrt(static_cast<double>(r.size())); }

Mismatch::Mismatch(const study::Prepared& scene, Registry& registry, const TuneQuestion& question,
                   std::vector<TunedValue> tuned_values, Measured measured)
    : tuned(std::move(tuned_values)),
      data(std::move(measured)),
      scene_(scene),
      registry_(registry),
      control_{question.control.interrupted, {}},
      jobs_(question.jobs > 0 ? question.jobs : std::max(1U, std::thread::hardware_concurrency())),
      step_(difference_step(scene.scene)) {}

std::vector<double> Mismatch::values(const VectorXd& z) const {
  std::vector<double> x;
  for (std::size_t i = 0; i < tuned.size(); ++i) x.push_back(tuned[i].value(z[static_cast<Index>(i)]));
  return x;
}

std::vector<std::string> Mismatch::settings(const VectorXd& z) const {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < tuned.size(); ++i)
    all.push_back(fmt::format("{}={}{}{}", tuned[i].path, to_digits(tuned[i].value(z[static_cast<Index>(i)]), 9),
                              tuned[i].unit.empty() ? "" : " ", tuned[i].unit));
  return all;
}

std::vector<MatchedRun> Mismatch::run(const std::vector<VectorXd>& points) {
  std::vector<std::vector<double>> all;
  for (const VectorXd& z : points) all.push_back(values(z));
  std::vector<MatchedRun> made = run_with(all);
  for (std::size_t k = 0; k < points.size(); ++k) keep_nearest(points[k], made[k]);
  return made;
}

void Mismatch::keep_nearest(const VectorXd& z, const MatchedRun& run) {
  if (!run.ok()) return;
  const double residual = root_mean_square(residuals(run));
  if (!nearest || residual < nearest->residual) nearest = NearestRun{settings(z), residual};
}

MatchedRun Mismatch::begin(const VectorXd& z, std::vector<std::string>& rounding) {
  // So little that of a smooth function no more than rounding is seen.
  constexpr double beside = 1e-13;
  VectorXd near = z;
  for (std::size_t i = 0; i < tuned.size(); ++i) near = moved(near, i, beside);
  std::vector<MatchedRun> made = run_with({values(z), values(near)});
  MatchedRun& run = made[0];
  for (std::size_t c = data.columns.size(); made[1].ok() && run.ok() && c-- > 0;) {
    const MeasuredColumn& column = data.columns[c];
    // What is over steps is to be a hundredth of what the parameters do.
    if (column.deviation_given || !felt_by(column, run.columns[c], made[1].columns[c], 0.01 * step_)) continue;
    rounding.insert(rounding.begin(), column.name);
    data.columns.erase(data.columns.begin() + static_cast<std::ptrdiff_t>(c));
    run.columns.erase(run.columns.begin() + static_cast<std::ptrdiff_t>(c));
  }
  keep_nearest(z, run);
  return std::move(run);
}

std::vector<MatchedRun> Mismatch::run_with(const std::vector<std::vector<double>>& points) {
  std::vector<SceneValues> scenes;
  for (const std::vector<double>& x : points) scenes.push_back(with_values(scene_.values, tuned, x));
  std::vector<MatchedRun> made = matched_runs(scenes, registry_, data, jobs_, control_);
  runs += made.size();
  for (const MatchedRun& m : made)
    if (!m.failure.empty()) ++failed, last_failure = m.failure;
  return made;
}

VectorXd Mismatch::residuals(const MatchedRun& run) const {
  VectorXd r(static_cast<Index>(data.count()));
  Index at = 0;
  for (std::size_t c = 0; c < data.columns.size(); ++c)
    for (std::size_t i = 0; i < data.times.size(); ++i)
      if (const double x = data.columns[c].values[i]; std::isfinite(x))
        r[at++] = (run.columns[c][i] - x) / data.columns[c].deviation;
  return r;
}

bool Mismatch::evaluate(const VectorXd& z, VectorXd& r) {
  const MatchedRun made = run({z}).front();
  if (!made.ok()) return false;
  r = residuals(made);
  return true;
}

bool Mismatch::derivatives(const VectorXd& z, const std::vector<std::size_t>& of, double step, MatrixXd& J) {
  struct Side {
    std::size_t run;
    double at;
  };
  std::vector<VectorXd> points = {z};
  for (const std::size_t i : of)
    for (const double side : {1.0, -1.0}) points.push_back(moved(z, i, side * step));
  const std::vector<MatchedRun> made = run(points);
  if (!made[0].ok()) return false;
  J.resize(static_cast<Index>(data.count()), static_cast<Index>(of.size()));
  for (std::size_t k = 0; k < of.size(); ++k) {
    const auto i = static_cast<Index>(of[k]);
    const auto side = [&](std::size_t point, double by) {
      return made[point].ok() ? Side{point, moved(z, of[k], by)[i]} : Side{0, z[i]};
    };
    const Side up = side(1 + 2 * k, step), down = side(2 + 2 * k, -step);
    if (!(up.at > down.at)) return false;
    J.col(static_cast<Index>(k)) = (residuals(made[up.run]) - residuals(made[down.run])) / (up.at - down.at);
  }
  return true;
}

bool Mismatch::sensitivity(const VectorXd& z, const std::vector<std::size_t>& of, Sensitivity& s) {
  MatrixXd fine, coarse;
  if (!derivatives(z, of, step_, fine) || !derivatives(z, of, 2 * step_, coarse)) return false;
  s.J = (4 * fine - coarse) / 3;
  // Of what is smooth a third; but what steps leave at random weighs by 4/3 in J.
  s.error = (fine - coarse).colwise().norm();
  return true;
}

VectorXd Mismatch::moved(VectorXd z, std::size_t i, double by) const {
  double& x = z[static_cast<Index>(i)];
  x = std::clamp(x + by, tuned[i].lower, tuned[i].upper);
  return z;
}

std::vector<ColumnFit> column_fits(const Measured& data, const MatchedRun& start, const MatchedRun& end) {
  std::vector<ColumnFit> fits;
  for (std::size_t c = 0; c < data.columns.size(); ++c) {
    const MeasuredColumn& column = data.columns[c];
    const auto rms = [&](const std::vector<double>& run) {
      double sum = 0;
      for (std::size_t i = 0; i < run.size(); ++i)
        if (const double r = run[i] - column.values[i]; std::isfinite(r)) sum += r * r;
      return std::sqrt(sum / static_cast<double>(column.count()));
    };
    ColumnFit fit;
    if (start.ok()) fit.at_start = start.columns[c], fit.before = rms(fit.at_start);
    fit.at_end = end.columns[c];
    fit.after = rms(fit.at_end);
    fit.correlation = neighbours(column, fit.at_end, fit.after, column.range());
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace withy::campaign
