/// \file
/// The table of a run as its report has it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "withy/results/recorder.hpp"
#include "withy/results/report/decimated_table.hpp"
#include "withy/results/report/derived_columns.hpp"
#include "withy/study/prepared.hpp"

namespace withy {

/// Takes the rows of a run and keeps of them, and of what is computed of each, as much as a page shows.
class ReportTable final : public Recorder {
 public:
  /// \param prepared the run's, which must outlive it
  /// The rest as DecimatedTable has it.
  ReportTable(const study::Prepared& prepared, std::size_t stretches, std::size_t samples, std::size_t numbers)
      : prepared_(prepared), kept_(stretches, samples, numbers) {}

  /// A run that goes on tells its columns twice.
  void begin(const std::vector<Column>& columns) override;
  void row(std::span<const double> numbers) override;
  RecordMark mark() override { return kept_.mark(); }
  void end() override {}

  /// Columns that were recorded, and behind them those that are derived.
  [[nodiscard]] const DecimatedTable& kept() const { return kept_; }
  [[nodiscard]] const std::vector<Column>& recorded() const { return recorded_; }
  /// Once it has begun.
  [[nodiscard]] const DerivedColumns& derived() const { return *derived_; }

 private:
  const study::Prepared& prepared_;
  DecimatedTable kept_;
  std::vector<Column> recorded_;
  std::optional<DerivedColumns> derived_;
  std::vector<double> row_;
};

}  // namespace withy
