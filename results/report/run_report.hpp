/// \file
/// What a report shows of one run.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/results/report/decimated_table.hpp"
#include "withy/results/report/looks.hpp"
#include "withy/study/run.hpp"

namespace withy {

/// Gathers a run's part of a report: its table as it goes, and at the end the moments of its animation.
class RunReport {
 public:
  /// The run must outlive it.
  explicit RunReport(const study::Prepared& prepared);
  /// Takes the table of the run.
  [[nodiscard]] Recorder& table() { return table_; }
  /// The part, for report_page.
  /// \param run content of run.json
  [[nodiscard]] std::string text(const study::CertifiedRun& ended, const nlohmann::ordered_json& run) const;
  /// The run as SVG: what a build without the page shows.
  [[nodiscard]] std::string picture() const;

 private:
  const study::Prepared& prepared_;
  Looks looks_;  ///< as they are before the run: a mesh that changes while it runs spoils nothing
  DecimatedTable table_;
};

}  // namespace withy
