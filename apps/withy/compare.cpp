#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/comparison_report.hpp"
#include "withy/results/formulation_words.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_comparison.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/study/variation_text.hpp"

namespace withy::app {
namespace {

struct CompareArguments : SceneArguments, OutputArguments {
  std::vector<std::string> formulations;  ///< empty: the usual ones that can treat the scene
  std::string reference = "quadratic";    ///< formulation that the others' errors are measured against
  std::string over;  ///< `path=value,value,…`: the comparison is made at each value; may be empty
};

ExitStatus compare(const CompareArguments& arguments) {
  const study::Variation variation =
      arguments.over.empty() ? study::Variation{"", {""}} : study::parse_variation(arguments.over);
  const std::string label = study::label_of(variation.path);
  const Plugins plugins(arguments);
  const SceneValues values = read_values(arguments);
  const Scene given = make_scene(values, plugins.registry());
  ComparisonQuestion question{arguments.formulations, arguments.reference, arguments.outputs, variation};
  std::vector<study::Unfit> left_out;
  if (question.formulations.empty())
    question.formulations = study::usual_formulations(given, plugins.registry(), left_out);
  const auto provenance = [&](const Scene& scene) { return provenance_of(scene, plugins); };
  const auto folder = take_folder(arguments, "compare", provenance(given), comparison_content(question));
  const std::vector<ComparisonAt> groups =
      record_comparison(arguments.out, values, plugins.registry(), question, provenance, run_control);
  const nlohmann::ordered_json j =
      comparison_json(groups, arguments.reference, variation.path, left_out, plugins.registry());
  std::string text = arguments.json
                         ? json_text(j)
                         : comparison_text(groups, arguments.reference, label) +
                               formulation_words(question.formulations, plugins.registry()) + left_out_text(left_out);
  if (!arguments.out.empty()) {
    write_file(*folder / "compare.json", json_text(j));
    if (!arguments.json) text += comparison_places(arguments.out, variation);
  }
  print(text);
  return groups.back().comparison.interrupted() ? ExitStatus::interrupted : ExitStatus::done;
}

void add_compare(Options& o, CompareArguments& a) {
  add_scene(o, a);
  o.list("--formulations,--formulation", a.formulations, "ID,ID,...",
         "Formulations; default: of ruthless,inconsistent,consistent,quadratic those that can treat the scene");
  o.value("--reference", a.reference, "ID", "Formulation the errors are measured against").with_default();
  o.list("--outputs,--output", a.outputs, "NAME,...",
         "What errors are shown of, each beside its range: hinges, tips, outputs (root, root.mz, shoulder.effort)");
  o.value("--over", a.over, "PATH=VALUE,VALUE,...", "Compare at each of these values of the scene");
  add_output(o, a, "Folder for results and pictures; default: nothing is kept");
}

}  // namespace

const Command compare_command = {"compare", "Simulate a scene in several formulations, side by side",
                                 "  withy compare scenes/two-link-slew.yaml\n"
                                 "  withy compare scenes/loads-of-the-slew.yaml --formulations quadratic,linear "
                                 "--reference exact --output root.mz,elbow_load.fx\n"
                                 "  withy compare scenes/two-link-slew.yaml --formulations ruthless,quadratic "
                                 "--over loads.slew.time_scale=1.0,1.2 --out results/comparison",
                                 &taking<CompareArguments, add_compare, compare>};

}  // namespace withy::app
