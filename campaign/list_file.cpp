#include "withy/campaign/list_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

#include "withy/scene/csv_rows.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

std::string text_of(const std::string& file) {
  try {
    return read_bytes(file);
  } catch (const std::system_error& e) {
    throw study::InputError(e.what());
  }
}

/// The names in a row of columns, each behind its path; empty where it has none.
std::string names_in(const std::vector<const Axis*>& columns, std::size_t row) {
  std::string names;
  for (const Axis* column : columns) {
    const Value value = column->levels.at(row);
    if (value.kind() == Value::Kind::text && !read_any_quantity(value.text()).value)
      names += column->path + '\n' + value.text() + '\n';
  }
  return names;
}

TrialRow row_of(const std::vector<Axis>& axes, const std::vector<const Axis*>& columns, std::size_t row) {
  TrialRow values;
  for (const Axis* column : columns)
    values.emplace_back(static_cast<std::size_t>(column - axes.data()), column->levels.at(row));
  return values;
}

bool is_value(const std::string& head) { return plain_number(head) || read_any_quantity(head).value; }

/// Numbers are kept apart as long as all levels are such.
void add_level(const std::string& cell, Levels& levels) {
  const auto x = plain_number(cell);
  if (levels.values.empty() && x) {
    levels.numbers.push_back(*x);
    return;
  }
  for (const double known : levels.numbers) levels.values.emplace_back(known);
  levels.numbers.clear();
  levels.values.push_back(x ? Value(*x) : Value(cell));
}

}  // namespace

std::vector<TrialRow> rows_of_names(const std::vector<Axis>& axes, const std::map<std::string, std::size_t>& grids) {
  std::vector<TrialRow> rows;
  for (const auto& [file, grid] : grids) {
    std::vector<const Axis*> columns;
    for (const Axis& axis : axes)
      if (!axis.drawn() && axis.grid == grid) columns.push_back(&axis);
    if (columns.empty()) continue;
    std::set<std::string> known{"", names_in(columns, 0)};
    for (std::size_t row = 1; row < columns.front()->levels.size(); ++row)
      if (known.insert(names_in(columns, row)).second) rows.push_back(row_of(axes, columns, row));
  }
  return rows;
}

ListColumn read_list_column(const std::string& file, const std::string& column, bool named) {
  const std::string text = text_of(file);
  CsvRows rows(text);
  const std::vector<std::string>& head = rows.head().cells;
  if (const std::string problem = rows.head_problem(); !problem.empty())
    throw study::InputError(fmt::format("{}:1:1: {}", file, problem));
  const auto at = std::find(head.begin(), head.end(), column);
  if (at == head.end() && (named || head.size() != 1))
    throw study::InputError(fmt::format("{}:1:1: no column {}{}", file, in_quotes(column), suggestion(column, head)));
  const std::size_t index = at == head.end() ? 0 : static_cast<std::size_t>(at - head.begin());
  ListColumn list{{}, sha256(text)};
  if (at == head.end() && is_value(head[0])) add_level(head[0], list.levels);
  for (CsvRow row; rows.next(row);) {
    const std::string problem = rows.problem(row);
    if (!problem.empty()) throw study::InputError(fmt::format("{}:{}:1: {}", file, row.line, problem));
    if (row.cells[index].empty())
      throw study::InputError(fmt::format("{}:{}:{}: got an empty cell; need a value of {}", file, row.line,
                                          row.columns[index], in_quotes(column)));
    add_level(row.cells[index], list.levels);
  }
  if (list.levels.size() == 0) throw study::InputError(file + ": need a head and at least one row");
  return list;
}

}  // namespace withy::campaign
