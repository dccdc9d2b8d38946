#include "withy/study/series.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <optional>
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

/// Of n⁻ᵖ the step from n − 1 to n over the one so many steps before.
double ratio_of(double n, double p, int back = 1) {
  const double first = n - back;
  return std::exp(p * std::log(first / n)) * std::expm1(-p * std::log1p(-1 / n)) /
         std::expm1(-p * std::log1p(-1 / first));
}

/// The exponent p of the law n⁻ᵖ whose step to n is `ratio` times the one so many steps before; nothing where no more
/// is left.
std::optional<double> exponent(double n, double ratio, int back = 1) {
  constexpr double slowest = 1, fastest = 500;
  if (!(ratio > ratio_of(n, fastest, back))) return {};
  if (ratio >= ratio_of(n, slowest, back)) return slowest;
  constexpr int bits = 40;
  std::uintmax_t most = 200;
  const auto found =
      boost::math::tools::toms748_solve([&](double at) { return ratio_of(n, at, back) - ratio; }, slowest, fastest,
                                        boost::math::tools::eps_tolerance<double>(bits), most);
  return 0.5 * (found.first + found.second);
}

/// What is left of n⁻ᵖ over its last step.
double left_over(double n, double p) { return 1 / std::expm1(-p * std::log1p(-1.0 / n)); }

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

int next_step(int modes) {
  constexpr int part = 4;
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(modes / part, 1))));
}

Tail tail(double n, double ratio) {
  const std::optional<double> p = exponent(n, ratio);
  if (!p) return {};
  ratio = std::min(ratio, ratio_of(n, 1));
  return {ratio / (1 - ratio), left_over(n, *p)};
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
  const int before = runs_.empty() ? modes : runs_.rbegin()->first;
  if (!runs_.empty()) changes_.push_back(distances(outputs_, run, last_).first);
  limit_before_ = std::exchange(limit_, run);
  if (runs_.empty()) limit_before_ = limit_;
  extrapolated_ = false;
  last_ = std::move(run);
  if (!runs_.empty() && modes == before) runs_.erase(modes);  // without modes runs differ by their tolerance alone
  runs_.emplace(modes, last_);
  ++size_;
  if (size_ == 1) return;
  if (kinds_ > 1 || modes == 0) {
    own_ = rest_of(changes_, kinds_);
    return;
  }
  int step = modes - before;
  const auto stepped = [&](int by) { return has(modes - by) && has(modes - 2 * by); };
  while (step < modes && !stepped(step)) ++step;
  if (step >= modes) {
    // One step tells no ratio: it may be the first of those of 1/n.
    own_ = changes_.back();
    for (double& d : own_) d *= static_cast<double>(before) / (modes - before);
    return;
  }
  Lead best = lead(modes, step, limits_);
  int far = std::max(step, modes / 4);
  while (!stepped(far)) --far;
  const Lead other = lead(modes, far, limits_of_far_);
  for (std::size_t k = 0; k < best.own.size(); ++k)
    if (other.own[k] < best.own[k]) take(k, other, best);
  limit_ = std::move(best.limit);
  own_ = std::move(best.own);
  extrapolated_ = std::find(best.moved.begin(), best.moved.end(), true) != best.moved.end();
}

/// Takes an output over.
void ModeSeries::take(std::size_t k, const Lead& from, Lead& to) const {
  const Output& output = outputs_.list()[k];
  to.own[k] = from.own[k];
  to.moved[k] = from.moved[k];
  for (std::size_t i = 0; i < to.limit.values.size(); ++i)
    std::copy_n(from.limit.values[i].begin() + static_cast<std::ptrdiff_t>(output.at), output.numbers(),
                to.limit.values[i].begin() + static_cast<std::ptrdiff_t>(output.at));
}

/// Where the last two of such steps lead to, output by output.
/// \param limits of such steps, by modes; that of the last is added
ModeSeries::Lead ModeSeries::lead(int modes, int step, std::map<int, Readings>& limits) const {
  Lead lead{last_, outputs_.none(), std::vector<bool>(outputs_.list().size(), false)};
  for (std::size_t k = 0; k < lead.own.size(); ++k) extrapolate(modes, step, k, lead);
  limits.insert_or_assign(modes, lead.limit);
  add_changes_of_limits(modes, step, limits, lead);
  return lead;
}

/// What is left of the sizes of an output's steps, over the last of them; that itself at least. They are taken to be
/// those of n⁻ᵖ, with the p that the last and the one two steps before it tell, where there are as many: those of even
/// and odd modes may differ much, and one that happens to be small is not what the next is measured by. Of the ratio of
/// two steps in a row and its root over three p would be too great: ratios grow with n.
double ModeSeries::goes_on(int modes, int step, std::size_t k) const {
  const Output& output = outputs_.list()[k];
  const auto size = [&](int at) { return greatest_of(output, steps(output, runs_.at(at), runs_.at(at - step))); };
  const int back = has(modes - 3 * step) ? 2 : 1;
  const double n = static_cast<double>(modes) / step, before = size(modes - back * step);
  const std::optional<double> p = before > 0 ? exponent(n, size(modes) / before, back) : 1.0;
  return p ? std::max(1.0, left_over(n, *p)) : 1;
}

/// No limit is known better than what is left of changes of limits that shrink on as the last two did, or as those of
/// runs do.
void ModeSeries::add_changes_of_limits(int modes, int step, const std::map<int, Readings>& limits, Lead& lead) const {
  const auto last = limits.find(modes), before_last = limits.find(modes - step), first = limits.find(modes - 2 * step);
  if (before_last == limits.end()) return;
  const Distances now = distances(outputs_, last->second, before_last->second).first;
  const Distances before =
      first != limits.end() ? distances(outputs_, before_last->second, first->second).first : outputs_.none();
  const double n = static_cast<double>(modes) / step;
  for (std::size_t k = 0; k < now.size(); ++k) {
    double left = goes_on(modes, step, k);
    if (before[k] > 0) left = std::min(left, std::max(1.0, tail(n, now[k] / before[k]).algebraic));
    lead.own[k] = std::max(lead.own[k], now[k] * left);
  }
}

/// Moves the limit of an output to where the last two steps lead, and sets what it may be off by.
void ModeSeries::extrapolate(int modes, int step, std::size_t k, Lead& lead) const {
  const Output& output = outputs_.list()[k];
  const Readings& between = runs_.at(modes - step);
  const Steps last = steps(output, last_, between), first = steps(output, between, runs_.at(modes - 2 * step));
  const Eigen::Index common = std::min(last.cols(), first.cols());
  const Steps now = last.leftCols(common), before = first.leftCols(common);
  const double n = static_cast<double>(modes) / static_cast<double>(step), size = greatest_of(output, now),
               size_before = greatest_of(output, before), square = before.squaredNorm();
  if (!std::isfinite(size) || !std::isfinite(size_before) || !(square > 0)) {
    lead.own[k] = size * (n - 1);
    return;
  }
  const double slowest = tail(n, 1).geometric, most_ratio = slowest / (1 + slowest);
  const double ratio = std::clamp(now.cwiseProduct(before).sum() / square, 0.0, most_ratio);
  const Tail left = tail(n, ratio);
  const double way = 0.5 * (left.geometric + left.algebraic);
  const double unlike = greatest_of(output, now - ratio * before);
  lead.own[k] = (left.algebraic - left.geometric) * size + goes_on(modes, step, k) * unlike;
  if (!(way > 0)) return;
  lead.moved[k] = true;
  for (Eigen::Index i = 0; i < common; ++i)
    move(output, way * now.col(i), lead.limit.values[static_cast<std::size_t>(i)]);
}

}  // namespace withy::study
