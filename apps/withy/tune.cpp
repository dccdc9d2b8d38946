#include "withy/campaign/tune.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/campaign/tune_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/scene_edit.hpp"

namespace withy::app {
namespace {

struct TuneArguments : SceneArguments, OutputArguments {
  campaign::TuneQuestion question;
  std::string write;  ///< file for the scene with the fitted values; empty: none
};

void write_fitted(const TuneArguments& arguments, const Engine& engine, const campaign::TuneResult& result) {
  std::vector<campaign::TunedValue> tuned;
  std::vector<double> values;
  for (const campaign::FittedValue& p : result.parameters) {
    if (p.state == campaign::FittedValue::State::undetermined) continue;
    tuned.push_back(p.tuned);
    values.push_back(p.value);
  }
  const SceneValues& scene = engine.prepared().values;
  write_changed(scene, changes_of(scene, tuned, values), arguments.write, engine.registry());
}

ExitStatus tune(const TuneArguments& arguments) {
  check_write(arguments.write, arguments);
  const Engine engine(arguments);
  const std::string title = engine.prepared().title();
  const auto folder = take_folder(arguments, "tune", provenance_of(engine.scene(), engine.plugins()),
                                  {"tune.json", "fit.csv", "fit.svg", report_name});
  campaign::TuneQuestion question = arguments.question;
  question.control = study_control("tune, starts");
  const campaign::TuneResult result = campaign::tune(engine.prepared(), engine.registry(), question);
  if (result.interrupted) return ExitStatus::interrupted;
  const nlohmann::ordered_json json = tune_json(result);
  if (folder != nullptr) write_file(*folder / "tune.json", json_text(json));
  if (arguments.json) print(json_text(json));
  if (!result.trouble.empty()) {
    complain(title + ": no fit: " + result.trouble);
    return ExitStatus::stopped;
  }
  if (folder != nullptr) {
    write_file(*folder / "fit.csv", tune_csv(result));
    const Picture picture = tune_picture(result, title + ": dots measured, grey before, line fitted");
    write_file(*folder / "fit.svg", svg_plot(picture));
    write_figures_page(*folder / report_name, title + ": fit to " + arguments.question.data, tune_text(result, title),
                       {{"", {}, picture.panels}});
  }
  if (!arguments.write.empty()) write_fitted(arguments, engine, result);
  std::string text = tune_text(result, title);
  if (folder != nullptr) text += "\nResults: " + arguments.out + '\n';
  if (!arguments.write.empty()) text += "\nwritten to " + arguments.write + '\n';
  if (!arguments.json) print(text);
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
