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

bool asked(const std::string& full, const std::string& given) {
  const std::string column = column_name(full), name = column_name(given);
  return column == name || (column.starts_with(name) && column[name.size()] == '.');
}

Curve curve_of(const DecimatedTable& table, std::size_t column, double scale) {
  Curve curve;
  const std::vector<double> times = table.column(0), numbers = table.column(column);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i])) continue;
    curve.x.push_back(times[i]);
    curve.y.push_back(scale * numbers[i]);
  }
  return curve;
}

Panel panel_of_column(const std::vector<NamedTable>& runs, const Column& column) {
  const bool angle = column.unit == "rad";
  const std::string unit = angle ? "deg" : (column.unit.empty() ? "1" : column.unit);
  Panel panel{"t [s]", column_name(column.name) + " [" + unit + "]", {}, {}};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const NamedTable& run : runs) {
    const auto& columns = run.table->columns();
    Curve curve;
    for (std::size_t c = 1; c < columns.size(); ++c)
      if (columns[c].name == column.name) curve = curve_of(*run.table, c, angle ? 180 / std::numbers::pi : 1);
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

/// What a component of a vector is beside: its label without the component.
std::string vector_of(const Panel& panel) {
  const std::string name = panel.y_label.substr(0, panel.y_label.find(" ["));
  return name.substr(0, name.find_last_of("._"));
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

}  // namespace

std::vector<Panel> table_panels(const std::vector<NamedTable>& runs, const std::vector<std::string>& names) {
  std::vector<Column> all;
  for (const NamedTable& run : runs) {
    for (std::size_t c = 1; c < run.table->columns().size(); ++c) {
      const Column& column = run.table->columns()[c];
      if (std::none_of(all.begin(), all.end(), [&](const Column& k) { return k.name == column.name; }))
        all.push_back(column);
    }
  }
  std::vector<Panel> panels;
  for (const std::string& name : names) {
    const std::size_t before = panels.size();
    for (const Column& column : all)
      if (asked(column.name, name)) panels.push_back(panel_of_column(runs, column));
    if (panels.size() > before) continue;
    std::vector<std::string> known;
    for (const Column& column : all) known.push_back(column_name(column.name));
    const std::string guess = nearest(name, known);
    throw ResultsError("there is no column " + in_quotes(name) +
                       (guess.empty() ? "" : "; did you mean " + in_quotes(guess) + "?"));
  }
  if (!names.empty()) {
    widen_rounding(panels);
    return panels;
  }
  for (const bool most : {true, false}) {
    for (const Column& column : all) {
      if (most != tells_most(column)) continue;
      Panel panel = panel_of_column(runs, column);
      if (changes(panel) && panels.size() < most_panels) panels.push_back(std::move(panel));
    }
    if (!panels.empty()) break;
  }
  widen_rounding(panels);
  return panels;
}

}  // namespace withy
