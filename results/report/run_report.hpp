/// \file
/// What a report shows of one run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "withy/results/report/looks.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/report/report_table.hpp"
#include "withy/study/run.hpp"

namespace withy {

class ArrayTexts;

/// Gathers a run's part of a report: its table as it goes, and at the end the moments of its animation.
class RunReport {
 public:
  /// The run must outlive it.
  explicit RunReport(const study::Prepared& prepared);
  /// Takes the table of the run.
  [[nodiscard]] Recorder& table() { return table_; }
  /// Writes the part, for report_page, a piece at a time.
  /// \param run content of run.json, as page_json
  void write(const study::CertifiedRun& ended, std::string_view run, const TextSink& write) const;
  /// The run as SVG: what a build without the page shows.
  [[nodiscard]] std::string picture() const;

 private:
  void write_motion(const std::vector<DecimatedTable::Row>& samples, const study::CertifiedRun& ended, ArrayTexts& data,
                    const TextSink& write) const;

  const study::Prepared& prepared_;
  Looks looks_;  ///< as they are before the run: a mesh that changes while it runs spoils nothing
  ReportTable table_;
};

}  // namespace withy
