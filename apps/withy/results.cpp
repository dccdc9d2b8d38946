#include "withy/apps/withy/results.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/checkpoint.hpp"
#include "withy/apps/withy/columns.hpp"
#include "withy/apps/withy/json_text.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/core/simulation/instants.hpp"

namespace withy::app {

namespace {

/// Where a run puts itself down, and where it goes on.
struct Continuation {
  const CheckpointFiles* files = nullptr;  ///< null: it is not put down
  double interval = 0;                     ///< wall time between checkpoints [s]
  std::optional<StoredRun> from;
};

/// Everything but run.json.
RunSummary simulate_to_csv(const std::filesystem::path& folder, const Engine& engine, SimulationExtras extras,
                           const Continuation& continuation, const std::function<void(const State&)>& also) {
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / "run.json");
  const ResultColumns columns(engine.model(), engine.equations());
  const std::filesystem::path table = folder / "results.csv";
  std::uintmax_t bytes = 0;
  if (continuation.from) {
    // What was written after the checkpoint is written again, the same.
    bytes = continuation.from->table_bytes;
    if (std::filesystem::exists(table) ? std::filesystem::file_size(table) < bytes : bytes > 0)
      throw InputError(table.string() + " is shorter than at its checkpoint; run without --resume to begin anew");
    std::filesystem::resize_file(table, bytes);
    extras.resume = &continuation.from->checkpoint;
  }
  OutputFile csv(table, continuation.from.has_value());
  const auto write = [&](const std::string& text) {
    csv.write(text);
    bytes += text.size();
  };
  if (!continuation.from) write(csv_head(columns.columns()));
  if (continuation.files != nullptr) {
    extras.checkpoint_seconds = continuation.interval;
    extras.checkpoint = [&](const Checkpoint& checkpoint) {
      csv.sync();
      continuation.files->write({checkpoint, bytes});
    };
  }
  RunSummary summary = engine.simulate(
      [&](const State& state) {
        write(csv_line(columns.row(state)));
        if (also) also(state);
      },
      extras);
  csv.close();
  return summary;
}

}  // namespace

RunSummary simulate_into(const std::filesystem::path& folder, const Engine& engine,
                         const std::function<void(const State&)>& also) {
  RunSummary summary = simulate_to_csv(folder, engine, {}, {}, also);
  write_file(folder / "run.json", json_text(run_json(engine, summary)));
  return summary;
}

CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments) {
  CertifiedRun run;
  run.beyond = next_model_up(engine, arguments);
  const CheckpointFiles files(folder, engine.scene());
  Continuation continuation{&files, arguments.checkpoint, {}};
  if (arguments.resume) {
    continuation.from = files.read();
  } else {
    files.remove();  // those of a run before
  }
  SimulationExtras extras;
  extras.beyond = run.beyond ? run.beyond->equations.get() : nullptr;
  run.summary = simulate_to_csv(folder, engine, extras, continuation, {});
  // Against `exact` the estimate costs more than it tells of most runs: on demand.
  const bool wanted = arguments.estimate == "always" ||
                      (arguments.estimate == "auto" && run.beyond && run.beyond->formulation == "quadratic");
  if (wanted && run.beyond && !has_switches(engine.model()) && run.summary.status != RunStatus::interrupted)
    run.estimate = estimate_error(engine, *run.beyond, run.summary);
  write_file(folder / "run.json", json_text(run_json(engine, run.summary, run.evidence())));
  if (run.summary.status != RunStatus::interrupted) files.remove();
  return run;
}

ExitStatus exit_status(RunStatus status) {
  switch (status) {
    case RunStatus::completed:
      return ExitStatus::done;
    case RunStatus::interrupted:
      return ExitStatus::interrupted;
    default:
      return ExitStatus::stopped;
  }
}

}  // namespace withy::app
