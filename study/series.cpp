#include "withy/study/series.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace withy::study {
namespace {

Eigen::Quaterniond orientation(const Output& output, const std::vector<double>& values) {
  const std::size_t at = output.at;
  return Eigen::Quaterniond(values[at], values[at + 1], values[at + 2], values[at + 3]).normalized();
}

void set_orientation(const Output& output, const Eigen::Quaterniond& q, std::vector<double>& values) {
  const std::size_t at = output.at;
  values[at] = q.w(), values[at + 1] = q.x(), values[at + 2] = q.y(), values[at + 3] = q.z();
}

/// Numbers that steps are made of. Of what a number has been over the run that is the first: the second is its range.
std::size_t stepping(const Output& output) { return output.shape == Output::Shape::vector ? 3 : 1; }

void correct(const Output& output, const std::vector<double>& b, const std::vector<double>& c, std::vector<double>& a) {
  if (output.shape == Output::Shape::orientation) {
    set_orientation(output, orientation(output, b) * orientation(output, c).conjugate() * orientation(output, a), a);
    return;
  }
  for (std::size_t i = output.at; i < output.at + stepping(output); ++i) a[i] += b[i] - c[i];
}

/// Goes a step further.
void move(const Output& output, const Eigen::Vector3d& step, std::vector<double>& values) {
  if (output.shape == Output::Shape::orientation) {
    const double angle = step.norm();
    if (!(angle > 0)) return;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, step / angle));
    set_orientation(output, turn * orientation(output, values), values);
    return;
  }
  for (std::size_t i = 0; i < stepping(output); ++i) values[output.at + i] += step[static_cast<Eigen::Index>(i)];
}

/// The greatest distance among steps; of what is known at the end of a run that at its end.
double greatest_of(const Output& output, const Eigen::Matrix3Xd& steps) {
  if (steps.cols() == 0) return 0;
  if (!steps.allFinite()) return std::numeric_limits<double>::infinity();
  return output.over_a_run() ? steps.rightCols<1>().norm() : steps.colwise().norm().maxCoeff();
}

/// Of n⁻ᵖ the step from n − 1 to n over the one before.
double ratio_of(int n, double p) {
  return -std::expm1(p * std::log1p(-1.0 / n)) / std::expm1(p * std::log1p(1.0 / (n - 2)));
}

/// What is left of sizes that shrink on by a ratio, over the last; that itself at least.
double goes_on(int modes, double ratio) { return std::max(1.0, tail(modes, ratio).algebraic); }

/// By what part an output's changes have shrunk from a run to the next, over the last two such steps where there are as
/// many: those of even and odd modes may differ much, and one that happens to be small is not what the next is measured
/// by. 1 where that is not known.
double shrinking(const std::vector<Distances>& changes, std::size_t output) {
  const std::size_t levels = changes.size();
  if (levels < 2) return 1;
  const std::size_t back = levels > 2 ? 2 : 1;
  const double before = changes[levels - 1 - back][output], ratio = changes.back()[output] / before;
  if (!(before > 0)) return 1;
  return back == 2 ? std::sqrt(ratio) : ratio;
}

/// What the finest of runs may be off by where no law of its series is known: the last change, or what is left of
/// changes that shrink on as the last two did; of several kinds of modes in turn the last change of each counts.
Distances rest_of(const std::vector<Distances>& changes, int kinds) {
  constexpr double most = 4;
  const std::size_t levels = changes.size();
  Distances rest = changes.back();
  for (std::size_t k = 0; levels > 1 && k < rest.size(); ++k) {
    const double before = changes[levels - 2][k];
    if (!(before > 0)) continue;
    const double ratio = std::min(rest[k] / before, most / (1 + most));
    rest[k] *= std::max(1.0, ratio / (1 - ratio));
  }
  for (std::size_t kind = 1; kind < std::min<std::size_t>(static_cast<std::size_t>(kinds), levels); ++kind)
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] = std::max(rest[k], changes[levels - 1 - kind][k]);
  return rest;
}

}  // namespace

Readings corrected(const Outputs& outputs, const Readings& a, const Readings& b, const Readings& c) {
  Readings sum = a;
  const std::size_t common = std::min({a.values.size(), b.values.size(), c.values.size()});
  sum.times.resize(common), sum.values.resize(common);
  for (std::size_t i = 0; i < common; ++i)
    for (const Output& output : outputs.list()) correct(output, b.values[i], c.values[i], sum.values[i]);
  return sum;
}

Tail tail(int n, double ratio) {
  constexpr double slowest = 1, fastest = 500;  // exponents p; beyond, nothing is left
  const double greatest_ratio = ratio_of(n, slowest);
  if (!(ratio > ratio_of(n, fastest))) return {};
  ratio = std::min(ratio, greatest_ratio);
  double p = slowest;
  if (ratio < greatest_ratio) {
    constexpr int bits = 40;
    std::uintmax_t most = 200;
    const auto found =
        boost::math::tools::toms748_solve([&](double at) { return ratio_of(n, at) - ratio; }, slowest, fastest,
                                          boost::math::tools::eps_tolerance<double>(bits), most);
    p = 0.5 * (found.first + found.second);
  }
  return {ratio / (1 - ratio), 1 / std::expm1(-p * std::log1p(-1.0 / n))};
}

ModeSeries::Steps ModeSeries::steps(const Output& output, const Readings& to, const Readings& from) const {
  const std::size_t common = std::min(to.values.size(), from.values.size());
  Steps all = Steps::Zero(3, static_cast<Eigen::Index>(common));
  for (std::size_t i = 0; i < common; ++i) {
    auto step = all.col(static_cast<Eigen::Index>(i));
    if (output.shape == Output::Shape::orientation) {
      const Eigen::AngleAxisd turn(orientation(output, to.values[i]) * orientation(output, from.values[i]).conjugate());
      step = turn.angle() * turn.axis();
      continue;
    }
    for (std::size_t k = 0; k < stepping(output); ++k)
      step[static_cast<Eigen::Index>(k)] = to.values[i][output.at + k] - from.values[i][output.at + k];
  }
  return all;
}

void ModeSeries::add(int modes, Readings run) {
  ++runs_;
  limit_before_ = std::exchange(limit_, run);
  extrapolated_ = false;
  if (runs_ == 1) {
    limit_before_ = limit_;
    last_ = std::move(run);
    return;
  }
  changes_.push_back(distances(outputs_, run, last_).first);
  const bool lawful = kinds_ == 1 && modes > 0;
  if (lawful) {
    before_ = std::move(now_);
    now_.clear();
    for (const Output& output : outputs_.list()) now_.push_back(steps(output, run, last_));
  }
  last_ = std::move(run);
  if (!lawful) {
    own_ = rest_of(changes_, kinds_);
  } else if (runs_ == 2) {
    // One step tells no ratio: it may be the first of those of 1/n.
    own_ = changes_.back();
    for (double& d : own_) d *= modes - 1;
  } else {
    own_ = outputs_.none();
    for (std::size_t k = 0; k < own_.size(); ++k) extrapolate(modes, k);
    if (runs_ > 3) add_changes_of_limits(modes);
  }
}

/// No limit is known better than what is left of changes of limits that shrink on as the last two did, or as those of
/// runs do.
void ModeSeries::add_changes_of_limits(int modes) {
  const Distances before = std::exchange(limits_changed_, distances(outputs_, limit_, limit_before_).first);
  for (std::size_t k = 0; k < own_.size(); ++k) {
    double shrinks = shrinking(changes_, k);
    if (!before.empty() && before[k] > 0) shrinks = std::min(shrinks, limits_changed_[k] / before[k]);
    own_[k] = std::max(own_[k], limits_changed_[k] * goes_on(modes, shrinks));
  }
}

/// Moves the limit of an output to where its last two steps lead, and sets what it may be off by.
void ModeSeries::extrapolate(int modes, std::size_t k) {
  const Output& output = outputs_.list()[k];
  const Eigen::Index common = std::min(now_[k].cols(), before_[k].cols());
  const Steps now = now_[k].leftCols(common), before = before_[k].leftCols(common);
  const double step = greatest_of(output, now), step_before = greatest_of(output, before),
               square = before.squaredNorm();
  if (!std::isfinite(step) || !std::isfinite(step_before) || !(square > 0)) {
    own_[k] = step * (modes - 1);
    return;
  }
  const double slowest = tail(modes, 1).geometric, most_ratio = slowest / (1 + slowest);
  const double ratio = std::clamp(now.cwiseProduct(before).sum() / square, 0.0, most_ratio);
  const Tail lead = tail(modes, ratio);
  const double way = 0.5 * (lead.geometric + lead.algebraic);
  const double unlike = greatest_of(output, now - ratio * before);
  own_[k] = (lead.algebraic - lead.geometric) * step + goes_on(modes, shrinking(changes_, k)) * unlike;
  if (!(way > 0)) return;
  extrapolated_ = true;
  for (Eigen::Index i = 0; i < common; ++i) move(output, way * now.col(i), limit_.values[static_cast<std::size_t>(i)]);
}

}  // namespace withy::study
