#include "withy/apps/withy/results.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::app {

namespace {

/// Where a run puts itself down, and where it goes on.
struct Continuation {
  const CheckpointFiles* files = nullptr;  ///< null: it is not put down
  double interval = 0;                     ///< wall time between checkpoints [s]
  std::optional<StoredRun> from;
};

/// A file of results under way.
class ResultsFile {
 public:
  /// \param from the run that goes on; null: it begins
  ResultsFile(const std::filesystem::path& folder, const Engine& engine, const StoredRun* from)
      : bytes_(prepared(folder, from)), csv_(folder / "results.csv", from != nullptr) {
    if (!engine.escalates()) columns_.emplace_back(engine.model(), engine.equations());
    for (const Rung& rung : engine.rungs()) columns_.emplace_back(engine.model(), *rung.equations);
    if (from == nullptr) write(csv_head(columns_.front().columns()));
  }
  /// Tips and energies are those of the formulation that the run is in.
  void write(const State& state, std::size_t rung) { write(csv_line(columns_[rung].row(state))); }
  /// Makes what was written last. \returns its length
  std::uintmax_t sync() {
    csv_.sync();
    return bytes_;
  }
  void close() { csv_.close(); }

 private:
  static std::uintmax_t prepared(const std::filesystem::path& folder, const StoredRun* from) {
    std::filesystem::create_directories(folder);
    std::filesystem::remove(folder / "run.json");
    if (from == nullptr) return 0;
    // What was written after the checkpoint is written again, the same.
    const std::filesystem::path table = folder / "results.csv";
    const std::uintmax_t bytes = from->table_bytes;
    if (std::filesystem::exists(table) ? std::filesystem::file_size(table) < bytes : bytes > 0)
      throw InputError(table.string() + " is shorter than at its checkpoint; run without --resume to begin anew");
    std::filesystem::resize_file(table, bytes);
    return bytes;
  }
  void write(const std::string& text) {
    csv_.write(text);
    bytes_ += text.size();
  }

  std::uintmax_t bytes_;
  OutputFile csv_;
  std::vector<ResultColumns> columns_;
};

/// Everything but run.json. `also` sees every output too.
CertifiedRun simulate_to_csv(const std::filesystem::path& folder, const Engine& engine, SimulationExtras extras,
                             const Continuation& continuation, const std::function<void(const State&)>& also) {
  CertifiedRun run;
  ResultsFile csv(folder, engine, continuation.from ? &*continuation.from : nullptr);
  const auto write = [&](const State& state, std::size_t rung) {
    csv.write(state, rung);
    if (also) also(state);
  };
  if (engine.escalates()) {
    run.escalated = engine.simulate_escalating(write);
    run.summary = run.escalated->summary;
  } else {
    if (continuation.from) extras.resume = &continuation.from->checkpoint;
    if (continuation.files != nullptr) {
      extras.checkpoint_seconds = continuation.interval;
      extras.checkpoint = [&](const Checkpoint& checkpoint) { continuation.files->write({checkpoint, csv.sync()}); };
    }
    run.summary = engine.simulate([&](const State& state) { write(state, 0); }, extras);
  }
  csv.close();
  return run;
}

}  // namespace

RunSummary simulate_into(const std::filesystem::path& folder, const Engine& engine,
                         const std::function<void(const State&)>& also) {
  const CertifiedRun run = simulate_to_csv(folder, engine, {}, {}, also);
  write_file(folder / "run.json", json_text(run_json(engine, run.summary, run.evidence())));
  return run.summary;
}

CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments) {
  const CheckpointFiles files(folder, fingerprint_of(value_json(engine.scene().source).dump() + WITHY_VERSION));
  Continuation continuation{&files, arguments.checkpoint.value_or(60), {}};
  if (arguments.resume) {
    continuation.from = files.read();
    if (!continuation.from->remark.empty()) complain(continuation.from->remark);
  } else {
    files.remove();  // those of a run before
  }
  std::optional<Beyond> beyond;
  if (!engine.escalates()) beyond = next_model_up(engine, arguments);
  SimulationExtras extras;
  extras.beyond = beyond ? beyond->equations.get() : nullptr;
  CertifiedRun run = simulate_to_csv(folder, engine, extras, continuation, {});
  run.beyond = std::move(beyond);
  const EquationsOfMotion* used = &engine.equations();
  if (run.escalated) {
    const std::size_t last = run.escalated->stretches.back().rung;
    if (last + 1 < engine.rungs().size() && !engine.model().layout().bodies.empty())
      run.beyond = compile_throughout(engine, arguments, engine.rungs()[last + 1].name);
    // A run that changed its formulation on the way has no estimate.
    const bool changed = run.escalated->stretches.back().start > engine.scene().initial.time;
    used = changed ? nullptr : engine.rungs()[last].equations;
  }
  // Against `exact` the estimate costs more than it tells of most runs: on demand.
  const bool wanted = arguments.estimate == "always" ||
                      (arguments.estimate == "auto" && run.beyond && run.beyond->formulation == "quadratic");
  if (wanted && used != nullptr && run.beyond && !has_switches(engine.model()) &&
      run.summary.status != RunStatus::interrupted)
    run.estimate = estimate_error(engine, *used, *run.beyond, run.summary);
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
