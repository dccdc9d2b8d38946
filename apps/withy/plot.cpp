#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/plotted_runs.hpp"
#include "withy/results/terminal_plot.hpp"

namespace withy::app {
namespace {

struct PlotArguments {
  std::vector<std::string> given;  ///< folders of runs, then columns
  std::string out;
  bool terminal = false;
  bool force = false;
  std::vector<double> over;  ///< a place [m] a column; empty: over time
  bool json = false;
};

ExitStatus plot(const PlotArguments& arguments) {
  const PlottedRuns runs(arguments.given);
  const DrawnRuns drawn = runs.drawn(arguments.over);
  if (drawn.picture.panels.empty()) {
    complain("nothing changes in what was recorded: name the columns to draw");
    return ExitStatus::bad_input;
  }
  if (arguments.terminal) {
    print(terminal_plot(drawn.picture.legend, drawn.picture.panels) + drawn.remarks());
    return ExitStatus::done;
  }
  const std::filesystem::path out = runs.picture(arguments.out, arguments.force);
  draw_plot(drawn.picture, out);
  print(arguments.json ? json_text({{"file", out.string()},
                                    {"columns", drawn.columns},
                                    {"of_columns", drawn.telling},
                                    {"left_out", drawn.left_out}})
                       : drawn.count() + " in " + out.string() + '\n' + drawn.remarks());
  return ExitStatus::done;
}

void add_plot(Options& o, PlotArguments& a) {
  o.argument("RUN", a.given,
             "Folders of runs, then names of columns, or what stands before a dot in them; without names: the "
             "coordinates of hinges and the deflections of tips")
      .required();
  o.value("--out", a.out, "FILE", "File of the picture, .svg or .png; default: plot.svg in the first folder");
  o.list("--over", a.over, "X,…",
         "A place [m] for each column: their least and greatest over these in place of time, an envelope");
  o.flag("--force", a.force, "Replace a plot.svg in the first folder that withy has not drawn");
  o.flag("--terminal", a.terminal, "Draw in the terminal");
  add_json(o, a.json).excludes("--terminal");
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
                              &taking<PlotArguments, add_plot, plot>};

}  // namespace withy::app
