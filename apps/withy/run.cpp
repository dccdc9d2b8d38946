#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/program/progress.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/check_columns.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/run_text.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/units.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

struct RunArguments : SceneArguments, OutputArguments {
  /// When the error against the next model up is estimated: auto (against `quadratic`), always, never.
  std::string estimate = "auto";
  /// Wall time between checkpoints [s]; 0: only where the run is interrupted; not given: 60.
  std::optional<double> checkpoint;
  std::optional<bool> hdf5;  ///< results.h5 too; not given: where HDF5 is there
  bool resume = false;       ///< go on from the checkpoint in the folder
  std::size_t threads = 1;   ///< that sweep the branches of the tree
};

/// The run keeps checkpoints, and begins or goes on from where it was.
RecordedRun recorded(const Engine& engine, const RunArguments& arguments) {
  const Provenance provenance = provenance_of(engine.scene(), engine.plugins());
  study::RunSettings settings;
  if (arguments.estimate != "auto")
    settings.estimate = arguments.estimate == "always" ? study::Estimate::always : study::Estimate::never;
  settings.control = run_control(engine.scene().formulation_name);
  settings.checkpoint_seconds = arguments.checkpoint.value_or(60);
  if (arguments.resume)
    return resume_run(arguments.out, engine.prepared(), engine.registry(), provenance, settings, {*arguments.hdf5},
                      complain);
  return begin_run(arguments.out, engine.prepared(), engine.registry(), provenance, settings, {*arguments.hdf5},
                   arguments.force ? FolderUse::replace : FolderUse::begin);
}

ExitStatus run(const RunArguments& given) {
  RunArguments arguments = given;
  const Engine engine(arguments, arguments.threads);
  study::check_start(engine.prepared());
  check_columns(engine.prepared(), arguments.outputs);
  if (!arguments.hdf5) arguments.hdf5 = hdf5_missing().empty();
  if (*arguments.hdf5 && !hdf5_missing().empty()) {
    complain("--hdf5: " + hdf5_missing());
    return ExitStatus::environment;
  }
  if (arguments.out.empty()) arguments.out = default_folder(arguments, engine.scene().formulation_name);
  const RecordedRun result = recorded(engine, arguments);
  const RunSummary& summary = result.run.summary;
  print(arguments.json ? read_bytes(arguments.out + "/run.json")
                       : run_table(engine.prepared(), summary) + extremes_text(result.outputs) +
                             certificate_text(engine.model(), summary, result.run.certificate) +
                             (has_report_page() ? folder_text(arguments.out)
                                                : "\nresults in " + arguments.out + ", drawn in its results.svg\n"));
  const ExitStatus status = ended(summary);
  if (status != ExitStatus::interrupted && program::interrupted()) {
    complain("interrupted after the run, while its error was estimated: its results are whole; run it again for that");
    return ExitStatus::interrupted;
  }
  if (status == ExitStatus::interrupted && summary.steps.evaluations > 0)
    complain("the same command with --resume goes on from there");
  return status;
}

void add_run(Options& o, RunArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_output(o, a, "Folder of the results; default: results/<scene>-<formulation>, with what is --set behind it");
  o.list("--outputs,--output", a.outputs, "NAME,...",
         "Outputs to add, by names as HINGE.effort, HINGE.reaction, FRAME.acceleration, BODY.section@X");
  o.value(
       "--estimate", a.estimate, "WHEN",
       "Estimate the error against the next model up: auto (where that is quadratic), always (and what one mode more "
       "changes), never")
      .among({"auto", "always", "never"})
      .with_default();

  o.value("--checkpoint", a.checkpoint, "SECONDS",
          "Wall time between checkpoints; 0: only where the run is interrupted; default: 60")
      .checked([](const std::string& text) {
        const auto seconds = plain_number(text);
        return seconds && *seconds >= 0 ? std::string() : "need a number of seconds, 0 or more";
      });
  o.flag("--hdf5,!--no-hdf5", a.hdf5,
         "Write the table as results.h5 too, with scene, certificate and versions; default: yes, where HDF5 is there");
  o.flag("--resume", a.resume,
         "Go on from the checkpoint in the folder of the results: the same command as before, and this");
  o.value("--threads", a.threads, "N", "Branches of a large tree on N threads").between(1UL, most_threads);
}

}  // namespace

const Command run_command = {"run", "Simulate a scene",
                             "  withy run scenes/two-link-slew.yaml\n"
                             "  withy run scenes/two-link-slew.yaml --formulation ruthless "
                             "--set loads.slew.time_scale=1.2 --out results/fast\n"
                             "  withy run scenes/pendulum.yaml --checkpoint 10",
                             &taking<RunArguments, add_run, run>};

}  // namespace withy::app
