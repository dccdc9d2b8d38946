/// \file
/// Where the rows of a run go.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/columns.hpp"

namespace withy {

/// How far a table has come: what a checkpoint keeps of it.
struct RecordMark {
  std::uint64_t rows = 0;
  std::uint64_t bytes = 0;  ///< of a file; 0 in memory
  std::string sha256;       ///< of these bytes; empty in memory
};

/// Takes a table row by row.
class Recorder {
 public:
  Recorder() = default;
  virtual ~Recorder() = default;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Names and units, once before the first row. A recorder that goes on with a table has them already, and says so
  /// where these are others. \throws ResultsError; std::system_error, as do the others
  virtual void begin(const std::vector<Column>& columns) = 0;
  /// As many numbers as there are columns, SI units.
  virtual void row(std::span<const double> numbers) = 0;
  /// Makes what there is last through a loss of power, and tells how far it is.
  virtual RecordMark mark() = 0;
  /// Once, after the last row: everything is known to be written.
  virtual void end() = 0;
};

/// Gives a table to several recorders. Its mark is that of the first.
class SharedRecorder final : public Recorder {
 public:
  /// They must outlive it; at least one.
  explicit SharedRecorder(std::vector<Recorder*> recorders) : recorders_(std::move(recorders)) {}
  void begin(const std::vector<Column>& columns) override;
  void row(std::span<const double> numbers) override;
  RecordMark mark() override;
  void end() override;

 private:
  std::vector<Recorder*> recorders_;
};

/// Keeps a table in memory.
class MemoryRecorder final : public Recorder {
 public:
  void begin(const std::vector<Column>& columns) override { columns_ = columns; }
  void row(std::span<const double> numbers) override { rows_.emplace_back(numbers.begin(), numbers.end()); }
  RecordMark mark() override { return {rows_.size(), 0, {}}; }
  void end() override {}

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] const std::vector<std::vector<double>>& rows() const { return rows_; }
  /// The numbers of a column from the first row to the last. \throws std::out_of_range where there is none of the name.
  [[nodiscard]] std::vector<double> column(const std::string& name) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace withy
