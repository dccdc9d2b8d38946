#include "withy/campaign/tune.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/campaign/tune_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/scene_edit.hpp"

namespace withy::app {
namespace {

struct TuneArguments : SceneArguments, OutputArguments {
  campaign::TuneQuestion question;
  std::string write;  ///< file for the scene with the fitted values; empty: none
};

ExitStatus tune(const TuneArguments& arguments) {
  const Engine engine(arguments);
  check_write(arguments.write, arguments, engine, arguments.question.data);
  const std::string title = engine.prepared().title();
  const auto folder = take_folder(arguments, "tune", provenance_of(engine.scene(), engine.plugins()),
                                  campaign::tune_content(), arguments.question.data);
  campaign::TuneQuestion question = arguments.question;
  question.control = study_control("tune, starts");
  const campaign::TuneResult result = campaign::tune(engine.prepared(), engine.registry(), question);
  if (result.interrupted) {
    if (const std::string text = campaign::interrupted_text(result); !text.empty()) complain(title + ": " + text);
    return ExitStatus::interrupted;
  }
  if (folder != nullptr) write_tune(folder->path(), result, title, arguments.question.data);
  if (arguments.json) print(json_text(tune_json(result)));
  if (!result.trouble.empty()) {
    complain(title + ": no fit: " + result.trouble);
    return ExitStatus::stopped;
  }
  if (!arguments.json) print(tune_text(result, title) + (folder != nullptr ? folder_text(arguments.out) : ""));
  if (!arguments.write.empty()) {  // once all is told that was found
    const SceneValues& scene = engine.prepared().values;
    write_changed(scene, fitted_changes(scene, result), arguments.write, engine.registry());
    if (!arguments.json) print("\nwritten to " + arguments.write + '\n');
  }
  return result.converged() ? ExitStatus::done : ExitStatus::stopped;
}

void add_tune(Options& o, TuneArguments& a) {
  campaign::TuneQuestion& q = a.question;
  add_scene(o, a);
  add_formulation(o, a);
  o.list("--parameters,--parameter", q.parameters, "PATH,...",
         "Numbers of the scene that are fitted, beginning at its values; bounds as PATH=2..3, \"PATH=2 mm..\"")
      .required();
  o.value("--match", q.data, "FILE", "Measured data: CSV with a head as t[s],tip.x[mm], its names those of results.csv")
      .required();
  o.list("--outputs,--output", q.outputs, "NAME,...",
         "Columns of the data that are compared; default: all that results have");
  o.list("--deviations,--deviation", q.deviations, "NAME=D,...",
         "Standard deviations of the measurement, as tip.x=0.1 mm; default: columns weigh by their ranges");
  o.value("--starts", q.starts, "N", "Searches: from the scene's values, others from within the bounds")
      .between(std::size_t{1}, std::size_t{10000})
      .with_default();
  o.value("--seed", q.seed, "N", "Of the starts").with_default();
  o.value("--jobs", q.jobs, "N", "Runs at once; default: one a core");
  o.value("--write", a.write, "FILE", "File for the scene with the fitted values; comments are kept");
  add_output(o, a, "Folder for report.html, tune.json, fit.csv and fit.svg; default: none is kept");
}

}  // namespace

const Command tune_command = {
    "tune", "Fit values of a scene to measured data, with their standard deviations",
    "  withy tune scenes/pendulum.yaml --match scenes/measured/pendulum.csv --parameters bodies.rod.center_of_mass.1\n"
    "  withy tune scenes/pendulum.yaml --match scenes/measured/pendulum.csv --parameters "
    "bodies.rod.center_of_mass.1=-0.8..-0.2,initial.hinges.pivot.position.0 --deviations pivot=0.2deg,rod.tip.x=2mm "
    "--starts 5 --out results/tune --write tuned.yaml",
    &taking<TuneArguments, add_tune, tune>};

}  // namespace withy::app
