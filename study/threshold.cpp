#include "withy/study/threshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace withy::study {
namespace {

struct Interrupted {};

/// Of the greatest value of the range: how exactly a crossing is found. Errors of runs have fewer digits.
constexpr double accuracy_of_runs = 1e-3, accuracy_of_frequencies = 1e-5;

/// The error of a point, run where it is not finished.
double error_of(TradeStudy& study, const Point& point) {
  const TradeResult* r = study.result(point);
  if (r == nullptr) {
    study.add(point);
    if (!study.run()) throw Interrupted();
    r = study.result(point);
  }
  return r->completed() ? r->relative_error : INFINITY;
}

Thresholds of_runs(TradeStudy& study, const std::vector<Point>& points, const Sweep& range, double limit) {
  if (!study.run()) throw Interrupted();
  Thresholds found;
  for (const Point& p : points) {
    Threshold row{p, "", {}, 0, {}};
    const auto error = [&](double v) { return error_of(study, at_value(p, range.path, v)); };
    for (const double v : range.values) row.errors.push_back(error(v));
    row.crossing = find_crossing(error, range.values, limit, accuracy_of_runs);
    found.rows.push_back(std::move(row));
  }
  for (const auto& [over, r] : study.references()) {
    found.reference = r.point.formulation;
    found.reference_modes = r.point.modes;
    found.reference_error = std::max(found.reference_error, r.relative_error);
  }
  return found;
}

Thresholds of_frequencies(const Prepared& base, Registry& registry, const FrequencyQuestion& question, double limit,
                          const Control& control) {
  FrequencyStudy study(base, registry, question);
  const Sweep& range = question.sweep;
  const bool from_rest = !range.spun().empty() && range.values.front() == 0;
  const auto all = static_cast<double>(question.points.size() * study.names().size());
  Thresholds found;
  for (const Point& p : question.points) {
    for (const std::string& mode : study.names()) {
      Threshold row{p, mode, {}, from_rest ? study.reference_frequency(mode, 0) : 0, {}};
      // Each takes a second where bodies have many modes: who waits is told, and may stop it, between any two.
      const auto error = [&](double v) {
        if (control.stop()) throw Interrupted();
        control.tell(static_cast<double>(found.rows.size()), all);
        return study.error(p, mode, v);
      };
      for (const double v : range.values) row.errors.push_back(error(v));
      row.crossing = find_crossing(error, range.values, limit, accuracy_of_frequencies);
      found.rows.push_back(std::move(row));
    }
  }
  found.reference = study.reference().formulation;
  found.reference_modes = study.reference().modes;
  found.reference_error = study.reference_error();
  found.frozen_from = study.frozen_from();
  return found;
}

}  // namespace

Point at_value(Point point, const std::string& path, double value) {
  point.over.push_back(fmt::format("{}={}", path, value));
  return point;
}

std::optional<Thresholds> thresholds_of_runs(const Prepared& base, Registry& registry, const std::vector<Point>& points,
                                             const Sweep& range, double limit, const TradeOptions& options) {
  std::vector<Point> all;
  for (const double v : range.values)
    for (const Point& p : points) all.push_back(at_value(p, range.path, v));
  TradeStudy study(base, registry, all, options);
  try {
    return of_runs(study, points, range, limit);
  } catch (const Interrupted&) {
    return {};
  }
}

std::optional<Thresholds> thresholds_of_frequencies(const Prepared& base, Registry& registry,
                                                    const FrequencyQuestion& question, double limit,
                                                    const Control& control) {
  try {
    return of_frequencies(base, registry, question, limit, control);
  } catch (const Interrupted&) {
    return {};
  }
}

}  // namespace withy::study
