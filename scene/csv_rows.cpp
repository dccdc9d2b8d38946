#include "withy/scene/csv_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace withy {
namespace {

/// Where the cells of a line begin, counted from 1.
std::vector<std::size_t> columns_of(std::string_view line) {
  std::vector<std::size_t> columns = {1};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] == ',' && !quoted) columns.push_back(i + 2);
  }
  return columns;
}

}  // namespace

std::vector<std::string> csv_cells(std::string_view line) {
  constexpr std::string_view blanks = " \t\r";
  std::vector<std::string> cells;
  for (std::size_t at = 0; at <= line.size(); ++at) {
    at = std::min(line.find_first_not_of(blanks, at), line.size());
    std::string cell;
    if (at < line.size() && line[at] == '"') {
      for (++at; at < line.size() && (line[at] != '"' || line.substr(at + 1, 1) == "\""); ++at) {
        if (line[at] == '"') ++at;
        cell += line[at];
      }
      at = std::min(line.find(',', at), line.size());
    } else {
      const std::size_t end = std::min(line.find(',', at), line.size());
      const std::size_t last = line.substr(at, end - at).find_last_not_of(blanks);
      if (last != std::string_view::npos) cell = line.substr(at, last + 1);
      at = end;
    }
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::string_view behind_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

CsvRows::CsvRows(std::string_view text) : rest_(behind_mark(text)) {
  const std::string_view line = next_line();
  head_ = {1, csv_cells(line), columns_of(line)};
}

std::string CsvRows::head_problem() const {
  if (head_.cells.size() > 1) return {};
  const std::size_t separator = head_.cells[0].find_first_of(";\t");
  if (separator == std::string::npos) return {};
  return fmt::format("got {} between the cells; need commas, and points in decimal numbers",
                     head_.cells[0][separator] == ';' ? "semicolons" : "tabs");
}

bool CsvRows::next(CsvRow& row) {
  while (!rest_.empty()) {
    const std::string_view line = next_line();
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    row = {line_, csv_cells(line), columns_of(line)};
    return true;
  }
  return false;
}

std::string CsvRows::problem(const CsvRow& row) const {
  if (row.cells.size() == head_.cells.size()) return {};
  return fmt::format("got {} cells; the head has {}", row.cells.size(), head_.cells.size());
}

std::string_view CsvRows::next_line() {
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  const std::string_view line = rest_.substr(0, end);
  const std::string_view after = rest_.substr(end);
  rest_ = after.substr(std::min<std::size_t>(after.starts_with("\r\n") ? 2 : 1, after.size()));
  ++line_;
  return line;
}

}  // namespace withy
