/// \file
/// Finished runs whose columns are drawn.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "withy/results/report/decimated_table.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy {

class PlottedRuns {
 public:
  /// Reads the tables. \param given folders of runs and tables, and all else is a name of columns
  /// \throws study::InputError where no run is among them; ResultsError, std::system_error
  explicit PlottedRuns(const std::vector<std::string>& given);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }    ///< of columns; may be empty
  [[nodiscard]] const std::vector<std::string>& legend() const { return legend_; }  ///< one a run
  /// The file to draw into: as it was given, or where that is empty plot.svg in the first folder.
  /// \throws study::InputError where it is one of the tables
  [[nodiscard]] std::filesystem::path picture(const std::string& given) const;
  /// A panel a column over time; or one of all columns over these places [m], as envelope_panel. Empty where nothing
  /// changes. \throws ResultsError where no run has such a column
  [[nodiscard]] std::vector<Panel> panels(const std::vector<double>& over) const;

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<DecimatedTable>> tables_;
  std::vector<std::string> names_, legend_;
};

}  // namespace withy
