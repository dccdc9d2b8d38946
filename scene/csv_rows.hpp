/// \file
/// CSV files that others wrote: rows of cells with their places. All that read such a file read it here.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace withy {

/// A row: its cells without the blanks around them, and where they stand, counted from 1.
struct CsvRow {
  std::size_t line = 0;
  std::vector<std::string> cells;
  std::vector<std::size_t> columns;  ///< where each cell begins in its line
};

/// The cells of a line, without blanks around them; a cell in quotes may hold commas and doubled quotes.
std::vector<std::string> csv_cells(std::string_view line);

/// A text behind the byte-order mark that spreadsheets put before what they export as UTF-8.
std::string_view behind_mark(std::string_view text);

/// The rows of a text in their order: first the head, then those below it. A byte-order mark, blank lines below the
/// head and any ends of lines are read over.
class CsvRows {
 public:
  /// \param text outlives the reader
  explicit CsvRows(std::string_view text);
  /// The first line; one empty cell where there is none.
  [[nodiscard]] const CsvRow& head() const { return head_; }
  /// That semicolons or tabs stand between the cells; else empty.
  [[nodiscard]] std::string head_problem() const;
  /// The next row that is not blank; false after the last.
  bool next(CsvRow& row);
  /// That the row has more or fewer cells than the head; else empty.
  [[nodiscard]] std::string problem(const CsvRow& row) const;
  /// The number of the last line that was read.
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  [[nodiscard]] std::string_view next_line();

  std::string_view rest_;
  std::size_t line_ = 0;
  CsvRow head_;
};

}  // namespace withy
