#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/inverse_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/study/recorded_motion.hpp"

namespace withy::app {
namespace {

struct InverseArguments : SceneArguments, OutputArguments {
  std::string motion;  ///< file with hinge coordinates over time; empty: the scene's motions
};

ExitStatus inverse(const InverseArguments& given) {
  InverseArguments arguments = given;
  const Engine engine(arguments);
  const auto [led, ignored] = study::led_scene(engine.prepared(), {arguments.motion, {}}, engine.registry());
  study::InverseStudy study(led);
  if (arguments.out.empty()) arguments.out = default_folder(arguments, "inverse");
  const std::filesystem::path folder = arguments.out;
  std::vector<std::string> content = run_content();
  content.emplace_back("inverse.svg");
  const Provenance provenance = provenance_of(led.scene, engine.plugins());
  const auto taken = take_folder(arguments, "inverse", provenance, content, arguments.motion);
  const study::RunSettings settings = study.run_settings(run_control(led.scene.formulation_name));
  const RunSummary summary = record_run(folder, led, engine.registry(), provenance, settings).run.summary;
  const Scene& scene = led.scene;
  const std::string title = led.title() + ": inverse dynamics";
  write_file(folder / "inverse.svg", inverse_picture(title, study));
  print(arguments.json ? json_text(inverse_json(scene, summary, study, ignored))
                       : inverse_text(title, scene, summary, study, ignored) +
                             folder_text(folder.string(), "results.csv, run.json and inverse.svg"));
  return ended(summary);
}

void add_inverse(Options& o, InverseArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  o.value("--motion", a.motion, "FILE",
          "CSV file with columns t[s] and hinge coordinates, in the place of the scene's motions");
  add_output(o, a, "Folder of the results; default: results/<scene>-inverse");
}

}  // namespace

const Command inverse_command = {
    "inverse", "Inverse dynamics: efforts that hinges need to follow their motions",
    "  withy inverse scenes/spin-up.yaml\n"
    "  withy inverse scenes/two-link-slew.yaml --motion scenes/motions/two-link-pick.csv --set loads={} "
    "--out results/pick",
    &taking<InverseArguments, add_inverse, inverse>};

}  // namespace withy::app
