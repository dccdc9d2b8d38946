#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/terms_files.hpp"
#include "withy/results/terms_text.hpp"
#include "withy/study/run.hpp"

namespace withy::app {
namespace {

struct TermsArguments : SceneArguments, OutputArguments {};

ExitStatus terms(const TermsArguments& arguments) {
  const Engine engine(arguments);
  const Scene& scene = engine.scene();
  const auto taken = take_folder(arguments, "terms", provenance_of(scene, engine.plugins()),
                                 {"terms.csv", "terms.svg", "terms.json", report_name});
  study::TermStudy study(engine.prepared(), engine.registry());
  const RunSummary summary = study::simulate(
      engine.prepared(), engine.registry(), [&](const State& state) { study.enter(state); },
      run_control(scene.formulation_name));
  const study::TermSizes& sizes = study.sizes();
  const nlohmann::ordered_json j = terms_json(scene, summary, sizes);
  const std::string title = engine.prepared().title();
  std::string text = arguments.json ? json_text(j) : terms_text(title, scene, summary, sizes);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    write_file(folder / "terms.csv", terms_csv(sizes));
    const Picture picture = terms_picture(title + ": terms along a run of " + scene.formulation_name, sizes);
    write_file(folder / "terms.svg", svg_plot(picture));
    write_figures_page(folder / report_name, picture.title, terms_tables(sizes),
                       {{"", picture.legend, picture.panels}});
    write_file(folder / "terms.json", json_text(j));
    if (!arguments.json) text += "\nreport.html, terms.csv, terms.svg and terms.json in " + folder.string() + '\n';
  }
  print(text);
  return ended(summary);
}

void add_terms(Options& o, TermsArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_output(o, a, "Folder for table, series and picture; default: nothing is kept");
}

}  // namespace

const Command terms_command = {"terms", "Measure the terms of the equations of motion along a run",
                               "  withy terms scenes/two-link-slew.yaml\n"
                               "  withy terms scenes/two-link-slew.yaml --formulation ruthless "
                               "--set loads.slew.time_scale=1.2 --out results/terms",
                               &taking<TermsArguments, add_terms, terms>};

}  // namespace withy::app
