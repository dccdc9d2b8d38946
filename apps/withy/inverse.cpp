#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/inverse_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/recorded_motion.hpp"

namespace withy::app {
namespace {

struct InverseArguments : SceneArguments, OutputArguments {
  std::string motion;  ///< file with hinge coordinates over time; empty: the scene's motions
};

std::string table_text(const study::InverseStudy& study) {
  TextTable table(
      {"<drive", "peak effort\n[N m, N]", "at\n[s]", "rms effort\n[N m, N]", "peak power\n[W]", "work\n[J]"});
  for (const study::Drive& drive : study.drives()) {
    const study::Demand d = study.demand(drive);
    table.add({drive.name, fmt::format("{:.5g}", d.peak), fmt::format("{:.4g}", d.peak_time),
               fmt::format("{:.5g}", d.rms), fmt::format("{:.5g}", d.peak_power), fmt::format("{:.5g}", d.work)});
  }
  return table.str();
}

/// The scene with the motions of the file in the place of its own.
study::Prepared led_scene(const Engine& engine, const std::string& file) {
  if (file.empty()) return engine.prepared();
  const study::RecordedMotion motion = study::read_recorded_motion(file, engine.model());
  return study::prepare(study::led_by(engine.prepared().values, motion), engine.registry());
}

ExitStatus inverse(const InverseArguments& given) {
  InverseArguments arguments = given;
  const Engine engine(arguments);
  const study::Prepared led = led_scene(engine, arguments.motion);
  study::InverseStudy study(led);
  if (arguments.out.empty()) arguments.out = default_folder(arguments, "inverse");
  const std::filesystem::path folder = arguments.out;
  std::vector<std::string> content = run_content();
  content.emplace_back("inverse.svg");
  const Provenance provenance = provenance_of(led.scene, engine.plugins());
  const auto taken = take_folder(arguments, "inverse", provenance, content);
  study::RunSettings settings;
  settings.look_beyond = false;
  settings.control = run_control(led.scene.formulation_name);
  settings.output = [&](const State& state, std::size_t) { study.enter(state); };
  const RunSummary summary = record_run(folder, led, engine.registry(), provenance, settings).run.summary;
  const Scene& scene = led.scene;
  const std::string title = led.title() + ": inverse dynamics";
  write_file(folder / "inverse.svg", inverse_picture(title, study));
  if (arguments.json) {
    print(json_text({{"scene", scene.file},
                     {"name", scene.name},
                     {"formulation", scene.formulation_name},
                     {"status", name(summary.status)},
                     {"message", summary.message},
                     {"t_end", summary.reached},
                     {"drives", drives_json(study)}}));
  } else {
    print(fmt::format("{} ({}, {}, {} outputs, {})\n\n{}\nresults.csv, run.json and inverse.svg in {}\n", title,
                      scene.formulation_name, scene.integrator_name, study.times().size(), study::outcome_text(summary),
                      table_text(study), folder.string()));
  }
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  return exit_status(summary.status);
}

std::function<ExitStatus()> add_inverse(CLI::App& c) {
  const auto arguments = std::make_shared<InverseArguments>();
  InverseArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  c.add_option("--motion", a.motion,
               "CSV file with columns t[s] and hinge coordinates, in the place of the scene's motions")
      ->type_name("FILE");
  add_output(c, a, "Folder of the results; default: results/<scene>-inverse");
  return [arguments] { return inverse(*arguments); };
}

}  // namespace

const Command inverse_command = {
    "inverse", "Efforts that hinges need to follow their motions, flexible bodies swinging along",
    "  withy inverse scenes/spin-up.yaml\n"
    "  withy inverse scenes/two-link-slew.yaml --motion scenes/motions/two-link-pick.csv --set loads={} "
    "--out results/pick",
    &add_inverse};

}  // namespace withy::app
