#include "withy/campaign/kept.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "withy/results/csv.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/measures.hpp"

namespace withy::campaign {
namespace {

constexpr std::array<std::string_view, 5> over_runs = {"min", "max", "mean", "rms", "integral"};

/// The output that has the motion of a hinge.
std::string motion_of(const std::string& hinge) { return hinge + ".motion"; }

/// Whether the table shows a column by this name; most names are shown as they are.
bool shown_as(const std::string& column, const std::string& name) {
  return column.find('[') == std::string::npos ? column == name : column_name(column) == name;
}

std::vector<std::size_t> where(const std::vector<Column>& columns, const std::vector<std::string>& names) {
  std::vector<std::size_t> found;
  for (const std::string& name : names) {
    const std::string shown = column_name(name);
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (shown_as(columns[i].name, shown)) found.push_back(i);
  }
  return found;
}

/// The columns that a name stands for: a hinge's coordinates, one column, a vector's components, or all that belong to
/// it; none where it is no name.
std::vector<std::size_t> select(const Model& model, const std::vector<Column>& columns, const std::string& name) {
  if (const int hinge = model.hinge(name); hinge >= 0) {
    std::vector<std::string> names;
    for (const Column& c : coordinate_columns(model.hinges()[static_cast<std::size_t>(hinge)])) names.push_back(c.name);
    return where(columns, names);
  }
  for (const std::vector<std::string>& names : {std::vector{name}, std::vector{name + ".x", name + ".y", name + ".z"},
                                                std::vector{name + "_x", name + "_y", name + "_z"}})
    if (std::vector<std::size_t> found = where(columns, names); !found.empty()) return found;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (column_name(columns[i].name).starts_with(column_name(name) + ".")) found.push_back(i);
  return found;
}

[[noreturn]] void refuse(const std::string& name) {
  throw study::InputError("the model of this case has no " + in_quotes(name));
}

/// The columns that a name stands for in the plan's own scene.
std::vector<Column> selected(const Plan& plan, const std::string& name) {
  const ResultColumns columns(plan.base->model(), *plan.base->equations, plan.base->scene.outputs);
  std::vector<Column> found;
  for (const std::size_t i : select(plan.base->model(), columns.columns(), name)) found.push_back(columns.columns()[i]);
  if (found.empty()) refuse(name);
  return found;
}

/// Where these are among the columns of a case, which may have more.
std::size_t place_of(const Column& wanted, const std::vector<Column>& columns) {
  const auto at = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == wanted.name; });
  if (at == columns.end()) refuse(column_name(wanted.name));
  return static_cast<std::size_t>(at - columns.begin());
}

/// Where the run's monitor has the greatest size of a column: the tip's deflection of a flexible body.
std::optional<std::pair<std::string, std::size_t>> deflection_of(const std::string& column) {
  constexpr std::string_view middle = ".tip.deflection_";
  const std::size_t at = column.rfind(middle);
  if (at == std::string::npos || at + middle.size() + 1 != column.size()) return {};
  return std::pair(column.substr(0, at), static_cast<std::size_t>(column.back() - 'x'));
}

/// A number of an output, by its name there and by the one it is asked for, and what is asked of it over a run.
struct OverRun {
  std::string output, number, shown, unit, what;
};

/// The number that has a hinge's rate among outputs, where its motion is one; the name itself where it is no rate.
std::string sensed_rate(const Model& model, const std::string& name) {
  for (const HingeNode& hinge : model.hinges())
    for (const Column& rate : rate_columns(hinge))
      if (rate.name == name) return motion_of(hinge.name) + name.substr(hinge.name.size());
  return name;
}

/// What "root_m.mz.max" names, "root_m.max" of every number of the output, and "shoulder.rate.max"; nothing where there
/// is none.
std::vector<OverRun> over_run(const study::Prepared& prepared, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return {};
  const std::string asked = name.substr(0, dot), what = name.substr(dot + 1);
  if (std::find(over_runs.begin(), over_runs.end(), what) == over_runs.end()) return {};
  const std::string sensed = sensed_rate(prepared.model(), asked);
  std::vector<OverRun> found;
  for (const SensorNode& node : prepared.scene.outputs)
    for (const Column& c : columns_of(node)) {
      if (c.name == name) return {};
      if (c.name == sensed || node.name == asked)
        found.push_back({node.name, c.name, c.name == sensed ? asked : c.name,
                         what == "integral" ? study::unit_over_time(c.unit) : c.unit, what});
    }
  return found;
}

double value_of(const OutputStatistics& s, const std::string& what) {
  if (what == "min") return s.least;
  if (what == "max") return s.greatest;
  if (what == "mean") return s.mean();
  if (what == "rms") return s.rms();
  return std::isfinite(s.least) ? s.integral : s.least;
}

}  // namespace

std::optional<std::string> output_of_rate(const Value& scene, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  const Value* hinges = scene.find("hinges");
  if (dot == std::string::npos || hinges == nullptr || hinges->kind() != Value::Kind::map) return {};
  if (std::find(over_runs.begin(), over_runs.end(), name.substr(dot + 1)) == over_runs.end()) return {};
  for (const auto& [hinge, definition] : hinges->members()) {
    if (!name.starts_with(hinge + ".") || hinge.size() + 1 >= dot) continue;
    const std::string number = name.substr(hinge.size() + 1, dot - hinge.size() - 1);
    const bool component = number.size() == 2 && std::string_view("wv").find(number[0]) != std::string_view::npos;
    if (component || number == "rate" || number.starts_with("rate.")) return motion_of(hinge);
  }
  return {};
}

std::string kept_problem(const study::Prepared& prepared, const std::string& name, bool at_end) {
  if (!over_run(prepared, name).empty()) return at_end ? "" : "is over the run already: need it under 'final'";
  const ResultColumns columns(prepared.model(), *prepared.equations, prepared.scene.outputs);
  if (!select(prepared.model(), columns.columns(), name).empty()) return {};
  std::vector<std::string> names;
  for (const HingeNode& h : prepared.model().hinges())
    if (!coordinate_columns(h).empty()) names.push_back(h.name);
  for (const Column& c : columns.columns()) names.push_back(c.name);
  return fmt::format("no result {}{}", in_quotes(name), suggestion(name, names));
}

std::vector<std::string> kept_columns(const Plan& plan) {
  std::vector<std::string> names;
  const auto add = [&](const char* what, const std::vector<std::string>& asked) {
    for (const std::string& name : asked) {
      const std::vector<OverRun> over = over_run(*plan.base, name);
      for (const OverRun& o : over) names.push_back(fmt::format("{}.{}.{}[{}]", what, o.shown, o.what, o.unit));
      if (!over.empty()) continue;
      for (const Column& c : selected(plan, name))
        names.push_back(fmt::format("{}.{}[{}]", what, column_name(c.name), c.unit.empty() ? "1" : c.unit));
    }
  };
  add("final", plan.final);
  add("peak", plan.peak);
  return names;
}

std::vector<std::string> history_columns(const Plan& plan) {
  std::vector<std::string> names;
  for (const std::string& name : plan.history.of)
    for (const Column& c : selected(plan, name))
      names.push_back(fmt::format("{}[{}]", column_name(c.name), c.unit.empty() ? "1" : c.unit));
  return names;
}

KeptPlaces kept_places(const Plan& plan, const study::Prepared& prepared, const std::vector<Column>& columns) {
  KeptPlaces places;
  for (const std::string& name : plan.final) {
    const std::vector<OverRun> over = over_run(*plan.base, name), of_case = over_run(prepared, name);
    for (const OverRun& o : over) {
      if (std::none_of(of_case.begin(), of_case.end(), [&](const OverRun& own) { return own.number == o.number; }))
        refuse(name);
      places.statistics.push_back({places.count++, o.number, o.what});
      if (std::find(places.watched.begin(), places.watched.end(), o.output) == places.watched.end())
        places.watched.push_back(o.output);
    }
    if (!over.empty()) continue;
    for (const Column& c : selected(plan, name)) places.final.push_back({places.count++, place_of(c, columns)});
  }
  for (const std::string& name : plan.peak)
    for (const Column& c : selected(plan, name)) {
      const std::size_t i = place_of(c, columns);
      if (const auto d = deflection_of(c.name))
        places.deflections.push_back({places.count++, d->first, d->second});
      else
        places.peaks.push_back({places.count++, i});
    }
  for (const std::string& name : plan.history.of)
    for (const Column& c : selected(plan, name)) places.histories.push_back(place_of(c, columns));
  return places;
}

KeptPlaces kept_places(const Plan& plan) {
  const ResultColumns columns(plan.base->model(), *plan.base->equations, plan.base->scene.outputs);
  return kept_places(plan, *plan.base, columns.columns());
}

KeptNumbers::KeptNumbers(const Plan& plan, const study::Prepared& prepared, const KeptPlaces& of_base)
    : columns_(columns_of_rungs(prepared)), histories_({}, plan.history.times) {
  const bool as_base =
      same_columns(plan.base->model(), plan.base->scene.outputs, prepared.model(), prepared.scene.outputs);
  places_ = as_base ? of_base : kept_places(plan, prepared, columns_.front().columns());
  histories_ = Histories(places_.histories, plan.history.times);
  numbers_.resize(places_.count);
}

void KeptNumbers::see_output(const State& state, std::size_t rung) {
  see(state, rung);
  if (histories_.any()) histories_.enter(state.time, columns_[rung].row(state));
}

void KeptNumbers::see(const State& state, std::size_t rung) {
  rung_ = rung;
  if (places_.peaks.empty()) return;
  const std::vector<double>& row = columns_[rung].row(state);
  for (const KeptPlaces::Number& peak : places_.peaks)
    numbers_[peak.at] = std::max(numbers_[peak.at], std::abs(row[peak.column]));
}

std::vector<double> KeptNumbers::numbers(const RunSummary& summary, const std::vector<OutputStatistics>& statistics) {
  const std::vector<double>& last = columns_[rung_].row(summary.final);
  for (const KeptPlaces::Number& f : places_.final) numbers_[f.at] = last[f.column];
  for (const KeptPlaces::Statistic& asked : places_.statistics)
    for (const OutputStatistics& s : statistics)
      if (s.name == asked.number) numbers_[asked.at] = value_of(s, asked.what);
  for (const KeptPlaces::Deflection& d : places_.deflections)
    numbers_[d.at] = summary.peak_deflection.at(d.body).at(d.axis);
  return numbers_;
}

}  // namespace withy::campaign
