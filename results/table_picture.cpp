#include "withy/results/table_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "withy/results/csv.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/names.hpp"

namespace withy {
namespace {

/// Panels where nothing in particular is asked for.
constexpr std::size_t most_panels = 8;

/// As tables have it: ratios have one in files of text, and none in others.
std::string shown_unit(const Column& column) { return column.unit.empty() ? "1" : column.unit; }

/// Metres of one run and radians of another are two quantities, whatever their name.
bool same_quantity(const Column& a, const Column& b) { return a.name == b.name && shown_unit(a) == shown_unit(b); }

bool asked(const std::string& full, const std::string& given) {
  const std::string column = column_name(full), name = column_name(given);
  if (column == name) return true;
  // A deflection as studies name it is that of three columns.
  const char next = name.ends_with(".deflection") ? '_' : '.';
  return column.starts_with(name) && column[name.size()] == next;
}

Curve curve_of(const DecimatedTable& table, std::size_t column, double scale) {
  Curve curve;
  const std::vector<double> times = table.column(0), numbers = table.column(column);
  bool gap = false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i])) {
      gap = !curve.x.empty();
      continue;
    }
    if (gap) curve.behind_gaps.push_back(curve.x.size());
    gap = false;
    curve.x.push_back(times[i]);
    curve.y.push_back(scale * numbers[i]);
  }
  return curve;
}

/// When the first of the runs begins, and the last of them ends.
std::pair<double, double> table_times(const std::vector<NamedTable>& runs) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const NamedTable& run : runs) {
    const std::vector<double> times = run.table->column(0);
    if (times.empty()) continue;
    first = std::min(first, times.front());
    last = std::max(last, times.back());
  }
  return first <= last ? std::pair(first, last) : std::pair(0.0, 0.0);
}

Panel panel_of_column(const std::vector<NamedTable>& runs, const Column& column) {
  const bool angle = column.unit == "rad";
  const std::string unit = angle ? "deg" : shown_unit(column);
  Panel panel{"t [s]", column_name(column.name) + " [" + unit + "]", {}, {}};
  panel.x_range = table_times(runs);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const NamedTable& run : runs) {
    const auto& columns = run.table->columns();
    Curve curve;
    for (std::size_t c = 1; c < columns.size(); ++c)
      if (same_quantity(columns[c], column)) curve = curve_of(*run.table, c, angle ? 180 / std::numbers::pi : 1);
    for (const double y : curve.y) {
      low = std::min(low, y);
      high = std::max(high, y);
    }
    panel.curves.push_back(std::move(curve));
  }
  panel.y_range = low <= high ? std::pair(low, high) : std::pair(0.0, 1.0);
  return panel;
}

bool changes(const Panel& panel) { return panel.y_range.first < panel.y_range.second; }

double size_of(const Panel& panel) { return std::max(std::abs(panel.y_range.first), std::abs(panel.y_range.second)); }

/// What a component of a vector is beside: its label without the component, with its unit.
std::string vector_of(const Panel& panel) {
  const std::size_t unit = panel.y_label.rfind(" [");
  const std::string name = panel.y_label.substr(0, unit);
  return name.substr(0, name.find_last_of("._")) + panel.y_label.substr(unit);
}

/// A component that is rounding beside the others of its vector gets their range: it is zero there.
void widen_rounding(std::vector<Panel>& panels) {
  constexpr double rounding = 1e-12;
  const std::vector<Panel> as_they_are = panels;
  for (Panel& panel : panels) {
    for (const Panel& other : as_they_are) {
      const double size = size_of(other);
      if (vector_of(other) == vector_of(panel) && size_of(panel) < rounding * size) panel.y_range = {-size, size};
    }
  }
}

/// Coordinates of hinges and deflections of tips.
bool tells_most(const Column& column) {
  const bool length = column.unit == "m" || column.unit == "rad";
  const bool place = column.name.find(".tip.") != std::string::npos;
  return length && (!place || column.name.find(".tip.deflection_") != std::string::npos);
}

/// Of all runs, each once; without time.
std::vector<Column> columns_of(const std::vector<NamedTable>& runs) {
  std::vector<Column> all;
  for (const NamedTable& run : runs) {
    for (std::size_t c = 1; c < run.table->columns().size(); ++c) {
      const Column& column = run.table->columns()[c];
      if (std::none_of(all.begin(), all.end(), [&](const Column& k) { return same_quantity(k, column); }))
        all.push_back(column);
    }
  }
  return all;
}

/// At least one.
std::vector<Column> asked_for(const std::vector<Column>& all, const std::string& name) {
  std::vector<Column> found;
  for (const Column& column : all)
    if (asked(column.name, name)) found.push_back(column);
  if (!found.empty()) return found;
  std::vector<std::string> known;
  for (const Column& column : all) known.push_back(column_name(column.name));
  const std::string guess = nearest(name, known);
  throw ResultsError("there is no column " + in_quotes(name) +
                     (guess.empty() ? "; there are: " + listed(known) : "; did you mean " + in_quotes(guess) + "?"));
}

}  // namespace

Panel envelope_panel(const std::vector<NamedTable>& runs, const std::vector<std::string>& columns,
                     const std::vector<double>& places) {
  const std::vector<Column> all = columns_of(runs);
  Panel envelope{"x [m]", {}, {}, {}};
  envelope.free_x = true;
  std::vector<Panel> of_columns;
  for (const std::string& name : columns) {
    const std::vector<Column> found = asked_for(all, name);
    if (found.size() > 1 && found[0].name == found[1].name)
      throw ResultsError(in_quotes(name) + " is in " + shown_unit(found[0]) + " in one run and in " +
                         shown_unit(found[1]) + " in another; need runs with one unit");
    if (found.size() > 1) throw ResultsError(in_quotes(name) + " is several columns; need one at each place");
    of_columns.push_back(panel_of_column(runs, found.front()));
    const std::string& label = of_columns.back().y_label;
    const std::string unit = label.substr(label.rfind(" ["));
    // "mz" of root.mz, middle.mz, tip.mz.
    const std::string kind =
        label.substr(0, label.rfind(" [")).substr(label.substr(0, label.rfind(" [")).rfind('.') + 1);
    if (envelope.y_label.empty()) envelope.y_label = kind + ", least and greatest" + unit;
    if (!envelope.y_label.ends_with(unit))
      throw ResultsError(in_quotes(name) + " has another unit than the columns before");
    envelope.y_range.first = std::min(envelope.y_range.first, of_columns.back().y_range.first);
    envelope.y_range.second = std::max(envelope.y_range.second, of_columns.back().y_range.second);
  }
  for (std::size_t run = 0; run < runs.size(); ++run) {
    Curve least, greatest;
    least.pen = greatest.pen = run;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::vector<double>& y = of_columns[k].curves[run].y;
      if (y.empty()) continue;
      const auto [low, high] = std::minmax_element(y.begin(), y.end());
      least.x.push_back(places[k]);
      greatest.x.push_back(places[k]);
      least.y.push_back(*low);
      greatest.y.push_back(*high);
    }
    envelope.curves.push_back(std::move(least));
    envelope.curves.push_back(std::move(greatest));
  }
  return envelope;
}

std::vector<Column> telling_columns(const std::vector<NamedTable>& runs) {
  const std::vector<Column> all = columns_of(runs);
  std::vector<Column> found;
  for (const bool most : {true, false}) {
    for (const Column& column : all)
      if (most == tells_most(column) && changes(panel_of_column(runs, column))) found.push_back(column);
    if (!found.empty()) break;
  }
  return found;
}

std::vector<Panel> table_panels(const std::vector<NamedTable>& runs, const std::vector<std::string>& names) {
  std::vector<Column> shown;
  if (names.empty()) {
    shown = telling_columns(runs);
    shown.resize(std::min(shown.size(), most_panels));
  } else {
    const std::vector<Column> all = columns_of(runs);
    for (const std::string& name : names)
      for (const Column& column : asked_for(all, name))  // names may have columns in common, as "slide", "slide.rate"
        if (std::none_of(shown.begin(), shown.end(), [&](const Column& k) { return same_quantity(k, column); }))
          shown.push_back(column);
  }
  std::vector<Panel> panels;
  for (const Column& column : shown) panels.push_back(panel_of_column(runs, column));
  widen_rounding(panels);
  return panels;
}

}  // namespace withy
