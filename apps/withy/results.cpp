#include "withy/apps/withy/results.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/output.hpp"
#include "withy/results/certificate_json.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/result_columns.hpp"

namespace withy::app {

namespace {

/// A file of results under way.
class ResultsFile {
 public:
  /// \param from the run that goes on; null: it begins
  ResultsFile(const std::filesystem::path& folder, const study::Prepared& scene, const StoredRun* from)
      : bytes_(prepared(folder, from)), csv_(folder / "results.csv", from != nullptr) {
    if (!scene.escalates()) columns_.emplace_back(scene.model(), *scene.equations);
    for (const Rung& rung : scene.rungs) columns_.emplace_back(scene.model(), *rung.equations);
    if (from == nullptr) write(csv_head(columns_.front().columns()));
  }
  /// Tips and energies are those of the formulation that the run is in.
  void write(const State& state, std::size_t rung) { write(csv_line(columns_[rung].row(state))); }
  /// The same where `seen()` is at that state; of a run that has one formulation.
  void write_seen(const State& state) { write(csv_line(columns_.front().row_of_seen(state))); }
  [[nodiscard]] Observation& seen() { return columns_.front().seen(); }
  /// Makes what was written last through a loss of power. \returns its length
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
    // For whoever watches a long run: a call of the system for every row costs more than the row.
    const Clock::time_point now = Clock::now();
    if (now - flushed_ < std::chrono::milliseconds(200)) return;
    csv_.flush();
    flushed_ = now;
  }

  using Clock = std::chrono::steady_clock;

  std::uintmax_t bytes_;
  Clock::time_point flushed_ = Clock::now();
  OutputFile csv_;
  std::vector<ResultColumns> columns_;
};

study::Estimate estimate_of(const std::string& text) {
  if (text == "always") return study::Estimate::always;
  return text == "never" ? study::Estimate::never : study::Estimate::automatic;
}

}  // namespace

RunSummary simulate_into(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                         const std::function<void(const State&)>& also) {
  ResultsFile csv(folder, prepared, nullptr);
  study::RunSettings settings;
  settings.look_beyond = false;
  settings.control = run_control(prepared.scene.formulation_name);
  const bool one = !prepared.escalates();
  if (one) settings.seen = &csv.seen();
  settings.output = [&](const State& state, std::size_t rung) {
    one ? csv.write_seen(state) : csv.write(state, rung);
    if (also) also(state);
  };
  const study::CertifiedRun run = study::run(prepared, registry, settings);
  csv.close();
  write_file(folder / "run.json", json_text(run_json(prepared.scene, run.summary, run.certificate)));
  return run.summary;
}

study::CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments) {
  const CheckpointFiles files(folder, fingerprint_of(value_json(engine.scene().source).dump() + WITHY_VERSION));
  std::optional<StoredRun> from;
  if (arguments.resume) {
    from = files.read();
    if (!from->remark.empty()) complain(from->remark);
  } else {
    files.remove();  // those of a run before
  }
  ResultsFile csv(folder, engine.prepared(), from ? &*from : nullptr);
  study::RunSettings settings;
  settings.estimate = estimate_of(arguments.estimate);
  settings.control = run_control(engine.scene().formulation_name);
  settings.output = [&](const State& state, std::size_t rung) { csv.write(state, rung); };
  if (!engine.prepared().escalates()) {
    settings.seen = &csv.seen();
    settings.output = [&](const State& state, std::size_t) { csv.write_seen(state); };
    settings.checkpoint_seconds = arguments.checkpoint.value_or(60);
    settings.checkpoint = [&](const Checkpoint& checkpoint) { files.write({checkpoint, csv.sync()}); };
    settings.resume = from ? &from->checkpoint : nullptr;
  }
  study::CertifiedRun run = study::run(engine.prepared(), engine.registry(), settings);
  csv.close();
  write_file(folder / "run.json", json_text(run_json(engine.scene(), run.summary, run.certificate)));
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
