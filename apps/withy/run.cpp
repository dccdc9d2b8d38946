#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/units.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

struct RunArguments : SceneArguments, OutputArguments {
  /// When the error against the next model up is estimated: auto (against `quadratic`), always, never.
  std::string estimate = "auto";
  /// Wall time between checkpoints [s]; 0: only where the run is interrupted; not given: 60.
  std::optional<double> checkpoint;
  bool hdf5 = true;     ///< results.h5 too
  bool resume = false;  ///< go on from the checkpoint in the folder
};

/// Refuses a tolerance below what the mass matrix leaves to be had, and a start at which it is singular.
void check_accuracy(const Engine& engine) {
  const Scene& scene = engine.scene();
  const Value* rtol = scene.source.at("integrator").find("rtol");
  const double tolerance = rtol != nullptr ? rtol->number() : 1.0;
  const std::string why = unattainable(engine.model(), engine.equations(), scene.initial, tolerance);
  if (why.empty()) return;
  throw InputError(rtol != nullptr ? scene.file + ": /integrator/rtol: got " + brief(tolerance) +
                                         ", an accuracy that cannot be had: " + why
                                   : scene.file + ": " + why);
}

study::Estimate estimate_of(const std::string& text) {
  if (text == "always") return study::Estimate::always;
  return text == "never" ? study::Estimate::never : study::Estimate::automatic;
}

/// The run of a formulation that keeps checkpoints, from its beginning or from where it was.
RecordedRun lasting_run(const Engine& engine, const RunArguments& arguments, const Provenance& provenance,
                        study::RunSettings settings) {
  settings.checkpoint_seconds = arguments.checkpoint.value_or(60);
  const std::filesystem::path folder = arguments.out;
  if (!arguments.resume) {
    const ResultsFolder taken(folder, "run", provenance, run_content(),
                              arguments.force ? FolderUse::replace : FolderUse::begin);
    return record_lasting_run(folder, engine.prepared(), engine.registry(), provenance, settings, nullptr,
                              {arguments.hdf5});
  }
  const CheckpointFiles files(folder, provenance.fingerprint());
  if (!files.exist()) throw ResultsError(folder.string() + " holds no checkpoint: there is nothing to resume");
  const ResultsFolder taken(folder, "run", provenance, run_content(), FolderUse::go_on);
  if (!taken.changed().empty())
    throw ResultsError(folder.string() + " belongs to another run: " + taken.changed() +
                       " changed since; run without --resume to begin anew");
  const StoredRun from = files.read();
  if (!from.remark.empty()) complain(from.remark);
  return record_lasting_run(folder, engine.prepared(), engine.registry(), provenance, settings, &from,
                            {arguments.hdf5});
}

RecordedRun recorded(const Engine& engine, const RunArguments& arguments) {
  const Provenance provenance = provenance_of(engine.scene(), engine.plugins());
  study::RunSettings settings;
  settings.estimate = estimate_of(arguments.estimate);
  settings.control = run_control(engine.scene().formulation_name);
  return lasting_run(engine, arguments, provenance, settings);
}

ExitStatus run(const RunArguments& given) {
  RunArguments arguments = given;
  const Engine engine(arguments);
  check_accuracy(engine);
  if (arguments.hdf5 && !hdf5_missing().empty()) {
    complain("--hdf5: " + hdf5_missing());
    return ExitStatus::environment;
  }
  if (arguments.out.empty()) arguments.out = default_folder(arguments, engine.scene().formulation_name);
  const RecordedRun ended = recorded(engine, arguments);
  const RunSummary& summary = ended.run.summary;
  print(arguments.json
            ? json_text(ended.json)
            : run_table(engine.prepared(), summary) + extremes_text(ended.json.value("outputs", Json::object())) +
                  certificate_text(engine.model(), summary, ended.run.certificate) + "\nresults in " + arguments.out +
                  (has_report_page() ? ", to look at in its report.html\n" : ", drawn in its results.svg\n"));
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  if (summary.status == RunStatus::interrupted) complain("the same command with --resume goes on from there");
  return exit_status(summary.status);
}

std::function<ExitStatus()> add_run(CLI::App& c) {
  const auto arguments = std::make_shared<RunArguments>();
  RunArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_output(c, a, "Folder of the results; default: results/<scene>-<formulation>, with what is --set behind it");
  c.add_option("--estimate", a.estimate,
               "Estimate the error against the next model up: auto (where that is quadratic), always, never")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();

  c.add_option("--checkpoint", a.checkpoint,
               "Wall time between checkpoints; 0: only where the run is interrupted; default: 60")
      ->type_name("SECONDS")
      ->check(CLI::Validator(
          [](std::string& text) {
            const auto seconds = plain_number(text);
            return seconds && *seconds >= 0 ? std::string() : "need a number of seconds, 0 or more";
          },
          ""));
  const CLI::Option* const hdf5 = c.add_flag(
      "--hdf5,!--no-hdf5", a.hdf5,
      "Write the table as results.h5 too, with scene, certificate and versions; default: yes, where HDF5 is there");
  c.add_flag("--resume", a.resume,
             "Go on from the checkpoint in the folder of the results: the same command as before, and this");
  return [arguments, hdf5] {
    if (hdf5->count() == 0) arguments->hdf5 = hdf5_missing().empty();
    return run(*arguments);
  };
}

}  // namespace

const Command run_command = {"run", "Simulate a scene",
                             "  withy run scenes/two-link-slew.yaml\n"
                             "  withy run scenes/two-link-slew.yaml --formulation ruthless "
                             "--set loads.slew.time_scale=1.2 --out results/fast\n"
                             "  withy run scenes/pendulum.yaml --checkpoint 10",
                             &add_run};

}  // namespace withy::app
