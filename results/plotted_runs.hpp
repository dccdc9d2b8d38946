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

/// What is drawn of runs, and what is not.
struct DrawnRuns {
  Picture picture;                            ///< a legend with one name a run; no panels where nothing changes
  std::size_t columns = 0;                    ///< drawn
  std::size_t telling = 0;                    ///< that might be: more where nobody named any and these are too many
  std::vector<std::string> left_out;          ///< names of runs without a number in these columns
  [[nodiscard]] std::string count() const;    ///< "8 of 36 columns"
  [[nodiscard]] std::string remarks() const;  ///< lines that say what is not drawn
};

/// Draws a picture into a file, as write_picture, with a mark by which PlottedRuns::picture knows it again.
void draw_plot(const Picture& picture, const std::filesystem::path& file);

class PlottedRuns {
 public:
  /// Reads the tables. \param given folders of runs and tables, and all else is a name of columns
  /// \throws study::InputError where no run is among them; ResultsError, std::system_error
  explicit PlottedRuns(const std::vector<std::string>& given);
  /// The file to draw into: as it was given, or where that is empty plot.svg in the first folder.
  /// \param force plot.svg may be a file that draw_plot() has not made
  /// \throws study::InputError where it is one of the tables, or such a file and `force` is false; std::system_error
  /// where plot.svg cannot be read
  [[nodiscard]] std::filesystem::path picture(const std::string& given, bool force) const;
  /// A panel a column over time; or one of all columns over these places [m], as envelope_panel.
  /// \throws ResultsError where no run has such a column; study::InputError where there are places, and not a finite
  /// one for each of the names
  [[nodiscard]] DrawnRuns drawn(const std::vector<double>& over) const;

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<DecimatedTable>> tables_;
  std::vector<std::string> names_;
};

/// Names of tables as a legend has them: a run's is its folder, with as many of the folders around it as tell those of
/// one name apart: "time_scale=1.0/quadratic", "time_scale=1.2/quadratic".
std::vector<std::string> run_names(const std::vector<std::filesystem::path>& tables);

}  // namespace withy
