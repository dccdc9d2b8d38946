#include "withy/results/recorded_run.hpp"

#include <optional>

#include "withy/results/certificate_json.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/report/run_report.hpp"

namespace withy {
namespace {

constexpr const char* table_name = "results.csv";
constexpr const char* summary_name = "run.json";
constexpr const char* picture_name = "results.svg";  ///< in the place of a report

RecordedRun simulate_into(CsvRecorder& csv, const std::filesystem::path& folder, const study::Prepared& prepared,
                          Registry& registry, const Provenance& provenance, study::RunSettings settings) {
  for (const char* old : {summary_name, report_name, picture_name}) std::filesystem::remove(folder / old);
  RunReport report(prepared);
  if (settings.resume != nullptr) read_csv(folder / table_name, report.table());
  SharedRecorder recorders({&csv, &report.table()});
  RunTable table(prepared, recorders);
  const bool seen = !prepared.escalates();
  if (seen) settings.seen = &table.seen();
  settings.output = [&table, seen, also = settings.output](const State& state, std::size_t rung) {
    if (seen) {
      table.add_seen(state);
    } else {
      table.add(state, rung);
    }
    if (also) also(state, rung);
  };
  RecordedRun recorded;
  recorded.run = study::run(prepared, registry, settings);
  recorders.end();
  recorded.json = run_json(prepared.scene, recorded.run.summary, recorded.run.certificate);
  recorded.json.update(provenance_json(provenance));
  write_file(folder / summary_name, json_text(recorded.json));
  if (has_report_page()) {
    recorded.report = report.text(recorded.run, recorded.json);
    write_report(folder / report_name, {prepared.title(), {recorded.report}});
  } else {
    write_file(folder / picture_name, report.picture());
  }
  return recorded;
}

}  // namespace

RunTable::RunTable(const study::Prepared& prepared, Recorder& recorder) : recorder_(recorder) {
  if (!prepared.escalates()) columns_.emplace_back(prepared.model(), *prepared.equations, prepared.scene.outputs);
  for (const Rung& rung : prepared.rungs)
    columns_.emplace_back(prepared.model(), *rung.equations, prepared.scene.outputs);
  recorder_.begin(columns_.front().columns());
}

std::vector<std::string> run_content() {
  return {table_name, summary_name, "checkpoint.cbor", "checkpoint.previous.cbor", report_name, picture_name};
}

RecordedRun record_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                       const Provenance& provenance, study::RunSettings settings) {
  std::filesystem::create_directories(folder);
  CsvRecorder csv(folder / table_name);
  return simulate_into(csv, folder, prepared, registry, provenance, std::move(settings));
}

RecordedRun record_lasting_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                               const Provenance& provenance, study::RunSettings settings, const StoredRun* from) {
  const CheckpointFiles files(folder, provenance.fingerprint());
  std::optional<CsvRecorder> csv;
  if (from != nullptr) {
    csv.emplace(folder / table_name, from->table);
    settings.resume = &from->checkpoint;
  } else {
    csv.emplace(folder / table_name);
  }
  settings.checkpoint = [&](const Checkpoint& checkpoint) { files.write({checkpoint, csv->mark(), {}}); };
  RecordedRun recorded = simulate_into(*csv, folder, prepared, registry, provenance, std::move(settings));
  if (recorded.run.summary.status != RunStatus::interrupted) files.remove();
  return recorded;
}

}  // namespace withy
