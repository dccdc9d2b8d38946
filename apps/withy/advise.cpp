#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/advice_picture.hpp"
#include "withy/results/advice_text.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/study/left_out.hpp"

namespace withy::app {
namespace {

/// What is advised is the cheapest of these that holds the accuracy.
struct AdviseArguments : SceneArguments, OutputArguments {
  std::string accuracy = "1%";
  study::Axes axes = study::usual_axes();  ///< families empty: the scene's, and another where it means the same beams
  std::string write;                       ///< file for the scene as advised; empty: none
  std::optional<double> seconds;           ///< of CPU time; nothing: as the scene's runs take
};

std::vector<std::string> texts_of(const std::vector<study::Change>& changes) {
  std::vector<std::string> texts;
  for (const study::Change& change : changes) texts.push_back(change.text());
  return texts;
}

ExitStatus advise(const AdviseArguments& arguments) {
  const Engine engine(arguments);
  check_write(arguments.write, arguments, engine);
  const auto folder =
      take_folder(arguments, "advise", provenance_of(engine.scene(), engine.plugins()), {"advice.json", report_name});
  const study::Accuracy accuracy = study::Accuracy::parse(arguments.accuracy);
  const study::Outputs outputs(engine.model(), arguments.outputs, engine.scene().outputs);
  const study::Candidates candidates = study::candidates_for(engine.prepared(), engine.registry(), arguments.axes);
  const auto [control, finding] = told_control("advise, s of CPU time");
  study::Evaluator evaluator(engine.prepared(), engine.registry(), outputs, control);
  const study::Advice advice = study::advise(evaluator, candidates, accuracy, finding, arguments.seconds);
  const AdviceQuestion question{engine.prepared(), outputs, accuracy};
  if (advice.interrupted) return ExitStatus::interrupted;
  if (!advice.choice) {
    const std::string why = no_advice_text(advice, question);
    if (arguments.json) print(json_text(search_json(question, advice, why)));
    complain(question_text(question) + ": no advice: " + why);
    return ExitStatus::stopped;
  }
  const std::string left_out = study::left_out(evaluator.model(advice.choice->point));
  const std::vector<study::Change> new_changes =
      study::new_changes(engine.scene(), advice.choice->point, engine.registry());
  const std::vector<std::string> changes = texts_of(new_changes);
  const std::string json = json_text(advice_json(question, advice, left_out, changes, scene_lines(changes)));
  const std::string words = advice_text({question, candidates, advice, left_out, changes});
  std::string text = arguments.json ? json : words;
  if (folder != nullptr) {
    write_file(*folder / "advice.json", json);
    write_figures_page(*folder / report_name, engine.prepared().title() + ": advice", words, {advice_picture(advice)});
    if (!arguments.json) text += folder_text(arguments.out);
  }
  print(text);
  if (!arguments.write.empty()) {  // once all is told that was found
    write_changed(engine.prepared().values, new_changes, arguments.write, engine.registry());
    if (!arguments.json) print("\nwritten to " + arguments.write + '\n');
  }
  return ExitStatus::done;
}

void add_advise(Options& o, AdviseArguments& a) {
  add_scene(o, a);
  o.value("--accuracy", a.accuracy, "A,...",
          "Greatest error of the outputs: a share of each one's own range, a length, an angle, or several")
      .with_default();
  o.list("--outputs,--output", a.outputs, "NAME,...",
         "What the accuracy is asked of: hinges, BODY.tip, BODY.tip.deflection, HINGE.motion_effort, outputs (root.mz, "
         "shoulder.effort); default: all but these last, and but hinges that motions drive");
  o.list("--formulations,--formulation", a.axes.formulations, "ID,...",
         "Formulations to choose from; default: all that take part in studies, plugins' too");
  o.list("--families,--family", a.axes.families, "ID,...",
         "Mode families of bending to choose from; default: the scene's and, of orthogonal-polynomials, craig-bampton, "
         "clamped-loaded with what is carried and vibration-modes, those that suit the same beams");
  o.list("--modes", a.axes.modes, "N,...",
         "Modes of each family of a beam to choose from; default: 1,2,3,4 and, where these will not do, to 8");
  o.list("--integrators", a.axes.integrators, "ID,...",
         "Integrators to choose from; default: dopri5,dop853 and, where installed, imex,radau,cvode");
  o.list("--tolerances", a.axes.tolerances, "R,...",
         "Relative tolerances to choose from; default: 1e-2,1e-3,1e-4,1e-5,1e-6");
  o.value("--seconds", a.seconds, "S",
          "CPU time that the search may take; default: 20 runs in quadratic, or 10 s if that is more");
  o.value("--write", a.write, "FILE", "File for the scene with what is advised; comments are kept");
  add_output(o, a, "Folder for report.html and advice.json; default: none is kept");
}

}  // namespace

const Command advise_command = {
    "advise", "Find the cheapest model and integration that hold an accuracy",
    "  withy advise scenes/pendulum.yaml --accuracy 1%\n"
    "  withy advise scenes/two-link-slew.yaml --set time.end=0.5 --accuracy 1mm,0.1deg --output payload.tip,elbow",
    &taking<AdviseArguments, add_advise, advise>};

}  // namespace withy::app
