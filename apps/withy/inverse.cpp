#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/results/inverse_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/study/recorded_motion.hpp"

namespace withy::app {
namespace {

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

}  // namespace

ExitStatus inverse(const InverseArguments& arguments) {
  const Engine engine(arguments);
  const study::Prepared led = led_scene(engine, arguments.motion);
  study::InverseStudy study(led);
  std::filesystem::path folder = arguments.out;
  if (folder.empty())
    folder = std::filesystem::path("results") / (std::filesystem::path(arguments.scene).stem().string() + "-inverse");
  const RunSummary summary =
      simulate_into(folder, led, engine.registry(), [&](const State& state) { study.enter(state); });
  const Scene& scene = led.scene;
  const std::string title = led.title() + ": inverse dynamics";
  write_file(folder / "inverse.svg", inverse_picture(title, study));
  if (arguments.json) {
    print(json_text({{"scene", scene.file},
                     {"name", scene.name},
                     {"formulation", scene.formulation_name},
                     {"status", name(summary.status)},
                     {"message", summary.message},
                     {"t_end", summary.final.time},
                     {"drives", drives_json(study)}}));
  } else {
    print(fmt::format("{} ({}, {}, {} outputs, {})\n\n{}\nresults.csv, run.json and inverse.svg in {}\n", title,
                      scene.formulation_name, scene.integrator_name, study.times().size(), study::outcome_text(summary),
                      table_text(study), folder.string()));
  }
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  return exit_status(summary.status);
}

}  // namespace withy::app
