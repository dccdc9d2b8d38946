#include "withy/campaign/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "withy/campaign/least_squares.hpp"
#include "withy/campaign/mismatch.hpp"
#include "withy/campaign/random.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<std::size_t>;

/// Why a fit would have no residuals to spare; empty where it has.
std::string too_few(const Measured& data, std::size_t parameters) {
  if (data.count() > parameters) return {};
  return fmt::format("{}: {} measured values; need more than the {} parameters", data.file, data.count(), parameters);
}

/// One call of `tune` after its input has been read.
class TuneSearch {
 public:
  TuneSearch(Mismatch& mismatch, const TuneQuestion& question)
      : m_(mismatch), question_(question), z_(VectorXd::Zero(static_cast<Index>(mismatch.tuned.size()))) {
    for (std::size_t i = 0; i < m_.tuned.size(); ++i) all_.push_back(i);
  }

  TuneResult found() {
    const MatchedRun start = begun();
    result_.data = m_.data;
    if (start.ok()) result_.before = root_mean_square(m_.residuals(start));
    if (start.ok() || question_.starts > 1)
      search();
    else
      result_.trouble = "the scene with its own values has no run to begin with: " + start.failure;
    result_.interrupted = m_.stopped();
    if (result_.interrupted) result_.nearest = m_.nearest;
    if (result_.trouble.empty() && !result_.interrupted) report(start);
    result_.runs = m_.runs, result_.failed = m_.failed, result_.last_failure = m_.last_failure;
    return std::move(result_);
  }

 private:
  /// The scene's own run, with the columns that can be compared. \throws study::InputError where what is left of the
  /// data is not what was asked for
  MatchedRun begun() {
    std::vector<std::string> rounding;
    MatchedRun start = m_.begin(z_, rounding);
    if (rounding.empty()) return start;
    if (!question_.outputs.empty() || m_.data.columns.empty())
      throw study::InputError(fmt::format(
          "{}:1:1: rounding alone changes {}, whose range cannot be weighed by: give the standard deviation "
          "of the measurement, --deviations {}=…",
          m_.data.file, listed(rounding), rounding.front()));
    for (const std::string& name : rounding) m_.data.ignored.push_back(name + " (changes by rounding alone)");
    if (const std::string few = too_few(m_.data, m_.tuned.size()); !few.empty()) throw study::InputError(few);
    return start;
  }
  void search() {
    look_for_undetermined();
    if (active_.empty()) {
      result_.trouble = "the data depend on none of the parameters";
      return;
    }
    constexpr int most_rounds = 2;
    for (int round = 0; round < most_rounds; ++round) {
      const Indices known = active_;
      if (!search_from_all()) return;
      look_again();
      // What the scene's own values hide, as a mass at rest, its end may tell; then no other start has looked for it.
      if (question_.starts == 1 || std::includes(known.begin(), known.end(), active_.begin(), active_.end())) return;
    }
  }

  /// The first start is the best that is known. \returns whether there is an end to go on from
  bool search_from_all() {
    const std::vector<VectorXd> others = promising();
    VectorXd best;
    double least = std::numeric_limits<double>::infinity();
    result_.starts.clear();
    for (std::size_t k = 0; k <= others.size() && !m_.stopped(); ++k) {
      SearchEnd& end = result_.starts.emplace_back();
      const VectorXd z = from(k == 0 ? z_ : others[k - 1], end);
      if (k == 0) end.from = m_.values(VectorXd::Zero(z_.size()));
      question_.control.tell(static_cast<double>(k + 1), static_cast<double>(question_.starts));
      if (!(end.residual < least)) continue;
      least = end.residual;
      best = z;
    }
    if (m_.stopped()) return false;
    if (best.size() == 0) {
      result_.trouble = "no start of the search has a run: " + m_.last_failure;
      return false;
    }
    std::stable_sort(result_.starts.begin(), result_.starts.end(),
                     [](const SearchEnd& a, const SearchEnd& b) { return a.residual < b.residual; });
    z_ = best;
    return true;
  }

  /// Where the end tells more or fewer parameters than the start did, the search goes on from there with these.
  void look_again() {
    constexpr int most_rounds = 3;
    for (int round = 0; round < most_rounds && !m_.stopped(); ++round) {
      const Indices before = active_;
      look_for_undetermined();
      if (active_ == before || active_.empty()) return;
      const std::vector<double> began = result_.starts.front().from;
      for (const Undetermined& u : undetermined_) z_[static_cast<Index>(u.coordinate)] = 0;
      z_ = from(z_, result_.starts.front());
      result_.starts.front().from = began;
    }
  }

  void look_for_undetermined() {
    Sensitivity s;
    if (active_.empty()) active_ = all_;
    if (!m_.sensitivity(z_, all_, s)) return;
    active_ = all_;
    undetermined_ = undetermined(s);
    for (const Undetermined& u : undetermined_) std::erase(active_, u.coordinate);
  }

  /// Where searches begin beside the scene's values: of ten points drawn for each, those with the least residuals.
  std::vector<VectorXd> promising() {
    constexpr std::size_t draws = 10;
    std::vector<std::pair<double, VectorXd>> points;
    for (std::size_t k = 1; k < question_.starts && !m_.stopped(); ++k) {
      std::vector<VectorXd> tried;
      for (std::size_t d = 0; d < draws; ++d) {
        tried.push_back(drawn(draws * k + d));
        points.emplace_back(std::numeric_limits<double>::infinity(), tried.back());
      }
      const std::vector<MatchedRun> runs = m_.run(tried);
      for (std::size_t d = 0; d < draws; ++d)
        if (runs[d].ok()) points[points.size() - draws + d].first = root_mean_square(m_.residuals(runs[d]));
    }
    std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<VectorXd> best;
    for (std::size_t k = 0; k < std::min(points.size(), question_.starts - 1); ++k)
      best.push_back(std::move(points[k].second));
    return best;
  }

  [[nodiscard]] VectorXd drawn(std::uint64_t point) const {
    constexpr double factor = 0.7;  // a factor of two, up or down
    VectorXd z = z_;
    for (const std::size_t i : active_) {
      const TunedValue& t = m_.tuned[i];
      const double u = Key(question_.seed)["start"][point][i].uniform();
      const bool bounded = std::isfinite(t.lower) && std::isfinite(t.upper);
      z[static_cast<Index>(i)] =
          bounded ? t.lower + u * (t.upper - t.lower) : std::clamp((2 * u - 1) * factor, t.lower, t.upper);
    }
    return z;
  }

  /// Searches from a point by the active coordinates; what it came to is noted.
  VectorXd from(const VectorXd& start, SearchEnd& end) {
    const auto whole = [&](const VectorXd& part) {
      VectorXd z = start;
      for (std::size_t k = 0; k < active_.size(); ++k) z[static_cast<Index>(active_[k])] = part[static_cast<Index>(k)];
      return z;
    };
    const auto part = [&](auto&& of) {
      VectorXd p(static_cast<Index>(active_.size()));
      for (std::size_t k = 0; k < active_.size(); ++k) p[static_cast<Index>(k)] = of(active_[k]);
      return p;
    };
    end.from = m_.values(start);
    VectorXd r, z = start;
    if (m_.evaluate(start, r)) {
      const LeastSquaresProblem problem{
          part([&](std::size_t i) { return m_.tuned[i].lower; }),
          part([&](std::size_t i) { return m_.tuned[i].upper; }),
          static_cast<Index>(m_.data.count()),
          [&](const VectorXd& p, VectorXd& out) { return m_.evaluate(whole(p), out); },
          [&](const VectorXd& p, MatrixXd& J) { return m_.derivatives(whole(p), active_, J); },
          [&] { return m_.stopped(); }};
      const LeastSquaresResult found =
          least_squares(problem, part([&](std::size_t i) { return start[static_cast<Index>(i)]; }));
      z = whole(found.z);
      end.converged = found.converged;
      end.reason = found.reason;
    }
    const bool runs = m_.evaluate(z, r);
    end.residual = runs ? root_mean_square(r) : std::numeric_limits<double>::infinity();
    if (!runs) end.reason = m_.last_failure;
    end.to = m_.values(z);
    return z;
  }

  void report(const MatchedRun& start);
  void add_parameters();
  void add_deviations(const VectorXd& residuals);
  void count_agreeing();

  Mismatch& m_;
  const TuneQuestion& question_;
  Indices all_, active_;
  std::vector<Undetermined> undetermined_;
  VectorXd z_;
  TuneResult result_;
};

void TuneSearch::report(const MatchedRun& start) {
  add_parameters();
  std::vector<MatchedRun> last = m_.run_with({result_.values()});
  if (!last.front().ok()) {
    result_.trouble = "the run with the fitted values fails: " + last.front().failure;
    return;
  }
  const VectorXd r = m_.residuals(last.front());
  result_.after = root_mean_square(r);
  result_.columns = column_fits(m_.data, start, last.front());
  if (result_.converged()) add_deviations(r);  // elsewhere the residuals are none of a minimum
  count_agreeing();
}

/// Relative changes of a value for one of its coordinate: of the value there, or of its scale where that is 0.
double relative_slope(const TunedValue& t, double z) {
  const double value = t.value(z);
  return t.slope(z) / (value != 0 ? value : t.scale);
}

/// Values with the digits that a scene is written with.
void TuneSearch::add_parameters() {
  for (std::size_t i = 0; i < m_.tuned.size(); ++i) {
    const double z = z_[static_cast<Index>(i)];
    const TunedValue& t = m_.tuned[i];
    FittedValue fitted{t, FittedValue::State::fitted, to_digits(t.value(z), 9), {}, {}};
    const double near = 1e-3 * std::min(1.0, t.upper - t.lower);
    if (z < t.lower + near || z > t.upper - near) fitted.state = FittedValue::State::at_bound;
    for (const Undetermined& u : undetermined_) {
      if (u.coordinate != i) continue;
      fitted.state = FittedValue::State::undetermined;
      for (const auto& [other, change] : u.same_as)
        fitted.same_as.emplace_back(
            other, change * relative_slope(m_.tuned[other], z_[static_cast<Index>(other)]) / relative_slope(t, z));
    }
    result_.parameters.push_back(std::move(fitted));
  }
}

/// Each column has a variance of its own, that of its residuals.
void TuneSearch::add_deviations(const VectorXd& residuals) {
  Indices free;
  for (std::size_t i = 0; i < result_.parameters.size(); ++i)
    if (result_.parameters[i].state == FittedValue::State::fitted) free.push_back(i);
  Sensitivity s;
  const auto values = static_cast<double>(residuals.size()), spare = values - static_cast<double>(free.size());
  if (free.empty() || spare < 1 || !m_.sensitivity(z_, free, s)) return;
  VectorXd variances(residuals.size());
  Index at = 0;
  for (const MeasuredColumn& column : m_.data.columns) {
    const auto count = static_cast<Index>(column.count());
    variances.segment(at, count).setConstant(residuals.segment(at, count).squaredNorm() / static_cast<double>(count) *
                                             values / spare);
    at += count;
  }
  const MatrixXd C = covariance(s.J, variances);
  const VectorXd sigma = C.diagonal().cwiseSqrt(), singular = singular_values(s.J);
  // Residuals of zero leave the correlations that equal ones would have.
  const MatrixXd R = variances.maxCoeff() > 0 ? C : covariance(s.J, VectorXd::Ones(residuals.size()));
  const VectorXd size = R.diagonal().cwiseSqrt();
  result_.singular_values.assign(singular.begin(), singular.end());
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto row = static_cast<Index>(k);
    FittedValue& p = result_.parameters[free[k]];
    p.deviation = std::abs(p.tuned.slope(z_[static_cast<Index>(free[k])])) * sigma[row];
    std::vector<double>& line = result_.correlation.emplace_back();
    for (Index j = 0; j < C.cols(); ++j)
      line.push_back(size[row] > 0 && size[j] > 0 ? R(row, j) / (size[row] * size[j]) : (row == j ? 1.0 : 0.0));
  }
}

/// Starts that came to the fitted values, within their deviations or a hundredth of their coordinates.
void TuneSearch::count_agreeing() {
  constexpr double deviations = 3, share = 0.01;
  for (SearchEnd& end : result_.starts) {
    bool same = std::isfinite(end.residual);
    for (std::size_t i = 0; i < result_.parameters.size(); ++i) {
      const FittedValue& p = result_.parameters[i];
      const double apart = std::abs(end.to[i] - p.value), slope = std::abs(p.tuned.slope(z_[static_cast<Index>(i)]));
      same = same && apart <= std::max(deviations * p.deviation.value_or(0), share * slope);
    }
    end.agrees = same;
    result_.agreeing += same ? 1 : 0;
  }
}

std::string lines_of(const std::vector<std::string>& problems) {
  std::string text;
  for (const std::string& p : problems) text += (text.empty() ? "" : "\n") + p;
  return text;
}

}  // namespace

std::vector<double> TuneResult::values() const {
  std::vector<double> x;
  for (const FittedValue& p : parameters) x.push_back(p.value);
  return x;
}

TuneResult tune(const study::Prepared& scene, Registry& registry, const TuneQuestion& question) {
  std::vector<std::string> problems;
  if (scene.escalates())
    problems.emplace_back("formulation: auto chooses its models in each run, so that a fit would jump; choose one");
  std::vector<TunedValue> tuned = read_tuned(question.parameters, scene, registry, problems);
  const ResultColumns results(scene.model(), *scene.equations, scene.scene.outputs);
  const double end = scene.scene.end.value_or(std::numeric_limits<double>::infinity());
  if (question.starts == 0) problems.emplace_back("starts: got 0; need at least 1");
  Measured data = read_measured(
      {question.data, question.outputs, question.deviations, scene.scene.initial.time, end, question.text},
      results.columns(), problems);
  if (problems.empty())
    if (std::string few = too_few(data, tuned.size()); !few.empty()) problems.push_back(std::move(few));
  if (!problems.empty()) throw study::InputError(lines_of(problems));
  Mismatch mismatch(scene, registry, question, std::move(tuned), std::move(data));
  return TuneSearch(mismatch, question).found();
}

std::vector<study::Change> fitted_changes(const SceneValues& scene, const TuneResult& result) {
  std::vector<TunedValue> tuned;
  std::vector<double> values;
  for (const FittedValue& p : result.parameters) {
    if (p.state == FittedValue::State::undetermined) continue;
    tuned.push_back(p.tuned);
    values.push_back(p.value);
  }
  return changes_of(scene, tuned, values);
}

}  // namespace withy::campaign
