#include "withy/results/plotted_runs.hpp"

#include "withy/results/csv_recorder.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/study/input_error.hpp"

namespace withy {
namespace {

namespace fs = std::filesystem;

/// More rows than a picture is wide are drawn by the least and the greatest of some together.
constexpr std::size_t most_rows = 2000;

constexpr const char* table_of_runs = "results.csv";

/// The table of a run's folder.
fs::path table_in(const std::string& folder) {
  fs::path table = fs::path(folder) / table_of_runs;
  if (!fs::exists(table)) table.replace_extension(".h5");
  if (!fs::exists(table)) throw study::InputError(folder + " holds no results.csv: it is no folder of a run");
  return table;
}

/// As a legend has it.
std::string name_of(const fs::path& table) {
  const fs::path folder = fs::absolute(table).parent_path();
  return table.stem() == "results" ? folder.filename().string() : table.filename().string();
}

}  // namespace

PlottedRuns::PlottedRuns(const std::vector<std::string>& given) {
  for (const std::string& text : given) {
    if (fs::is_directory(text))
      files_.push_back(table_in(text));
    else if (fs::is_regular_file(text))
      files_.emplace_back(text);
    else
      names_.push_back(text);
  }
  if (files_.empty()) throw study::InputError("there is no folder '" + given.front() + "'");
  for (const fs::path& file : files_) {
    tables_.push_back(std::make_unique<DecimatedTable>(most_rows, 0));
    const OpenLine last = file.filename() == table_of_runs ? OpenLine::left_out : OpenLine::taken;
    file.extension() == ".h5" ? read_hdf5(file, *tables_.back()) : read_csv(file, *tables_.back(), last);
    legend_.push_back(name_of(file));
  }
}

fs::path PlottedRuns::picture(const std::string& given) const {
  const fs::path out = given.empty() ? files_.front().parent_path() / "plot.svg" : fs::path(given);
  keep_inputs(out, files_);
  return out;
}

std::vector<Panel> PlottedRuns::panels(const std::vector<double>& over) const {
  std::vector<NamedTable> runs;
  for (std::size_t i = 0; i < tables_.size(); ++i) runs.push_back({legend_[i], tables_[i].get()});
  if (over.empty()) return table_panels(runs, names_);
  return {envelope_panel(runs, names_, over)};
}

}  // namespace withy
