/// \file
/// As much of a table as a picture can show.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "withy/results/recorder.hpp"

namespace withy {

/// Keeps of a table of any length the least and the greatest number of each column over stretches of rows, so that no
/// peak is lost, and whole rows at regular intervals. Memory does not grow with the rows.
class DecimatedTable final : public Recorder {
 public:
  /// \param stretches kept at most; half as many at least where there are more rows
  /// \param samples the same of whole rows
  /// \param numbers where given, as many stretches as have so many numbers in all columns together, within 200 and
  ///   `stretches`: a picture of many columns stays small
  DecimatedTable(std::size_t stretches, std::size_t samples, std::size_t numbers = 0);
  /// What another has kept, of its first columns alone.
  DecimatedTable(const DecimatedTable& whole, std::size_t columns);

  void begin(const std::vector<Column>& columns) override;
  void row(std::span<const double> numbers) override;
  RecordMark mark() override { return {rows_, 0, {}}; }
  void end() override {}

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// Rows that were given.
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// How many of them a stretch is.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  /// A column: of each stretch one number where it is one row, or else the least and the greatest in their order. The
  /// first column, the time, has the stretch's first and last.
  [[nodiscard]] std::vector<double> column(std::size_t index) const;
  using Row = std::shared_ptr<const std::vector<double>>;
  /// Whole rows, the first and the last among them.
  [[nodiscard]] std::vector<Row> samples() const;

 private:
  /// One column over one stretch: its least and its greatest number, in the order in which they came.
  struct Range {
    double first, second;
  };
  /// Every column over one stretch. Short tables have each row twice, as a stretch and a sample, which share it.
  struct Stretch {
    Row row;                    ///< the only one so far
    std::vector<Range> ranges;  ///< of several
    [[nodiscard]] Range at(std::size_t column) const;
  };
  static void widen(Range& range, const Range& next);
  static void join(Stretch& stretch, const Stretch& next);
  void halve();

  std::size_t most_stretches_, most_samples_, most_numbers_;
  std::vector<Column> columns_;
  std::size_t rows_ = 0, stride_ = 1, sample_stride_ = 1;
  std::vector<Stretch> stretches_;
  std::vector<Row> samples_;
  Row last_;
};

}  // namespace withy
