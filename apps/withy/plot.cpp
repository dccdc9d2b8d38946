#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/results/terminal_plot.hpp"
#include "withy/study/input_error.hpp"

namespace withy::app {
namespace {

namespace fs = std::filesystem;

/// More rows than a picture is wide are drawn by the least and the greatest of some together.
constexpr std::size_t most_rows = 2000;

struct PlotArguments {
  std::vector<std::string> given;  ///< folders of runs, then columns
  std::string out;
  bool terminal = false;
  std::vector<double> over;  ///< a place [m] a column; empty: over time
  bool json = false;
};

/// What is given, taken apart: a folder or a table is a run, all else a column.
struct Asked {
  std::vector<fs::path> tables;
  std::vector<std::string> names;
};

Asked asked_for(const std::vector<std::string>& given) {
  Asked asked;
  for (const std::string& text : given) {
    if (fs::is_directory(text)) {
      fs::path table = fs::path(text) / "results.csv";
      if (!fs::exists(table)) table.replace_extension(".h5");
      if (!fs::exists(table)) throw study::InputError(text + " holds no results.csv: it is no folder of a run");
      asked.tables.push_back(table);
    } else if (fs::is_regular_file(text)) {
      asked.tables.emplace_back(text);
    } else {
      asked.names.push_back(text);
    }
  }
  if (asked.tables.empty()) throw study::InputError("there is no folder '" + given.front() + "'");
  return asked;
}

std::string name_of(const fs::path& table) {
  const fs::path folder = fs::absolute(table).parent_path();
  return table.stem() == "results" ? folder.filename().string() : table.filename().string();
}

ExitStatus plot(const PlotArguments& arguments) {
  const Asked asked = asked_for(arguments.given);
  std::vector<std::unique_ptr<DecimatedTable>> tables;
  std::vector<NamedTable> runs;
  std::vector<std::string> legend;
  for (const fs::path& file : asked.tables) {
    tables.push_back(std::make_unique<DecimatedTable>(most_rows, 0));
    file.extension() == ".h5" ? read_hdf5(file, *tables.back()) : read_csv(file, *tables.back());
    legend.push_back(name_of(file));
    runs.push_back({legend.back(), tables.back().get()});
  }
  if (!arguments.over.empty() && arguments.over.size() != asked.names.size()) {
    complain("--over has " + std::to_string(arguments.over.size()) + " places for " +
             std::to_string(asked.names.size()) + " columns; need one each");
    return ExitStatus::bad_input;
  }
  const std::vector<Panel> panels = arguments.over.empty()
                                        ? table_panels(runs, asked.names)
                                        : std::vector<Panel>{envelope_panel(runs, asked.names, arguments.over)};
  if (panels.empty()) {
    complain("nothing changes in what was recorded: name the columns to draw");
    return ExitStatus::bad_input;
  }
  if (arguments.terminal) {
    print(terminal_plot(legend, panels));
    return ExitStatus::done;
  }
  const fs::path out =
      arguments.out.empty() ? asked.tables.front().parent_path() / "plot.svg" : fs::path(arguments.out);
  write_file(out, svg_plot(legend.size() == 1 ? legend.front() : "", legend, panels));
  const std::size_t count = panels.size();
  print(arguments.json ? json_text({{"file", out.string()}, {"columns", count}})
                       : std::to_string(count) + (count == 1 ? " column in " : " columns in ") + out.string() + '\n');
  return ExitStatus::done;
}

std::function<ExitStatus()> add_plot(CLI::App& c) {
  const auto arguments = std::make_shared<PlotArguments>();
  PlotArguments& a = *arguments;
  c.add_option("RUN", a.given,
               "Folders of runs, then names of columns, or what stands before a dot in them; without names: the "
               "coordinates of hinges and the deflections of tips")
      ->required();
  c.add_option("--out", a.out, "File of the picture; default: plot.svg in the first folder")->type_name("FILE");
  c.add_option("--over", a.over,
               "A place [m] for each column: their least and greatest over these in place of time, an envelope")
      ->delimiter(',')
      ->type_name("X,…");
  CLI::Option* const terminal = c.add_flag("--terminal", a.terminal, "Draw in the terminal");
  add_json(c, a.json)->excludes(terminal);
  return [arguments] { return plot(*arguments); };
}

}  // namespace

const Command plot_command = {"plot", "Draw columns of finished runs",
                              "  withy run scenes/pendulum.yaml\n"
                              "  withy plot results/pendulum-quadratic\n"
                              "  withy plot results/pendulum-quadratic pivot kinetic_energy --terminal\n"
                              "  withy plot results/pendulum-quadratic rod.tip --out tip.svg\n"
                              "  withy run scenes/loads-of-the-slew.yaml\n"
                              "  withy plot results/loads-of-the-slew-quadratic root.mz middle.mz end.mz --over "
                              "0,0.4572,0.9144",
                              &add_plot};

}  // namespace withy::app
