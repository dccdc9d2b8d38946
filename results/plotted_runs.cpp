#include "withy/results/plotted_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/results/csv_recorder.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/picture_file.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/scene/document.hpp"
#include "withy/study/input_error.hpp"

namespace withy {
namespace {

namespace fs = std::filesystem;

/// More rows than a picture is wide are drawn by the least and the greatest of some together.
constexpr std::size_t most_rows = 2000;

constexpr const char* table_of_runs = "results.csv";

/// The last line of a picture.
constexpr const char* mark_of_plots = "<!-- drawn by withy plot -->\n";

/// The table of a run's folder.
fs::path table_in(const std::string& folder) {
  fs::path table = fs::path(folder) / table_of_runs;
  if (!fs::exists(table)) table.replace_extension(".h5");
  if (!fs::exists(table)) throw study::InputError(folder + " holds no results.csv: it is no folder of a run");
  return table;
}

/// Folders from the root to a run, or to a table that is by itself and its name.
std::vector<std::string> path_of(const fs::path& table) {
  std::vector<std::string> parts;
  for (const fs::path& part : fs::absolute(table).lexically_normal()) parts.push_back(part.string());
  if (table.stem() == "results" && parts.size() > 2) parts.pop_back();
  return parts;
}

std::string last_parts(const std::vector<std::string>& parts, std::size_t count) {
  std::string text;
  for (std::size_t i = parts.size() - std::min(count, parts.size()); i < parts.size(); ++i)
    text += (text.empty() || text.ends_with('/') ? "" : "/") + parts[i];
  return text;
}

void check_places(const std::vector<double>& over, const std::vector<std::string>& columns) {
  if (!over.empty() && over.size() != columns.size())
    throw study::InputError(
        fmt::format("--over has {} places for {} columns; need one each", over.size(), columns.size()));
  for (const double place : over)
    if (!std::isfinite(place)) throw study::InputError(fmt::format("--over: got {}; need finite places", place));
}

/// Runs that have a number in one of the panels, each of which has so many curves a run.
std::vector<NamedTable> with_numbers(const std::vector<NamedTable>& runs, const std::vector<Panel>& panels,
                                     std::size_t curves) {
  std::vector<NamedTable> drawn;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (std::any_of(panels.begin(), panels.end(),
                    [&](const Panel& panel) { return !panel.curves[curves * i].x.empty(); }))
      drawn.push_back(runs[i]);
  return drawn;
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
  }
}

fs::path PlottedRuns::picture(const std::string& given, bool force) const {
  const fs::path otherwise = files_.front().parent_path() / "plot.svg";
  const bool own = given.empty() && fs::is_regular_file(otherwise) && read_bytes(otherwise).ends_with(mark_of_plots);
  return output_name(given, otherwise, force || own, files_);
}

void draw_plot(const Picture& picture, const fs::path& file) { write_picture(file, svg_plot(picture) + mark_of_plots); }

DrawnRuns PlottedRuns::drawn(const std::vector<double>& over) const {
  check_places(over, names_);
  const std::vector<std::string> names = run_names(files_);
  std::vector<NamedTable> runs;
  for (std::size_t i = 0; i < tables_.size(); ++i) runs.push_back({names[i], tables_[i].get()});
  const auto panels_of = [&](const std::vector<NamedTable>& some) {
    return over.empty() ? table_panels(some, names_) : std::vector<Panel>{envelope_panel(some, names_, over)};
  };
  DrawnRuns drawn;
  std::vector<Panel>& panels = drawn.picture.panels = panels_of(runs);
  // A name in the legend without a curve would look as if its curve lay below another.
  if (const auto some = with_numbers(runs, panels, over.empty() ? 1 : 2); !some.empty() && some.size() < runs.size()) {
    for (const NamedTable& run : runs)
      if (std::none_of(some.begin(), some.end(), [&](const NamedTable& k) { return k.table == run.table; }))
        drawn.left_out.push_back(run.name);
    runs = some;
    panels = panels_of(runs);
  }
  for (const NamedTable& run : runs) drawn.picture.legend.push_back(run.name);
  if (runs.size() == 1) drawn.picture.title = runs.front().name;
  drawn.columns = over.empty() ? panels.size() : over.size();
  drawn.telling = names_.empty() ? telling_columns(runs).size() : drawn.columns;
  return drawn;
}

std::string DrawnRuns::count() const {
  const std::string drawn = columns < telling ? fmt::format("{} of {}", columns, telling) : fmt::format("{}", columns);
  return drawn + (telling == 1 ? " column" : " columns");
}

std::string DrawnRuns::remarks() const {
  std::string text;
  if (columns < telling) text += fmt::format("{} more change: name those to draw\n", telling - columns);
  for (const std::string& run : left_out) text += run + " has no number in these columns and is not drawn\n";
  return text;
}

std::vector<std::string> run_names(const std::vector<fs::path>& tables) {
  std::vector<std::vector<std::string>> paths;
  for (const fs::path& table : tables) {
    paths.push_back(path_of(table));
    // Two tables of one folder.
    const auto beside = [&](const fs::path& other) {
      return other != table && other.parent_path() == table.parent_path();
    };
    const std::string name = table.filename().string();
    if (paths.back().back() != name && std::any_of(tables.begin(), tables.end(), beside)) paths.back().push_back(name);
  }
  std::vector<std::string> names;
  for (const auto& own : paths) {
    std::size_t count = 1;
    const auto alike = [&](const auto& other) {
      return other != own && last_parts(other, count) == last_parts(own, count);
    };
    while (count < own.size() && std::any_of(paths.begin(), paths.end(), alike)) ++count;
    names.push_back(last_parts(own, count));
  }
  return names;
}

}  // namespace withy
