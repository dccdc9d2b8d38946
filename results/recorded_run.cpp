#include "withy/results/recorded_run.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <optional>

#include "withy/results/certificate_json.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/checkpoint_files.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/hdf5_recorder.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/make_folder.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/report/run_report.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/run_json.hpp"

namespace withy {
namespace {

constexpr const char* table_name = "results.csv";
constexpr const char* summary_name = "run.json";
constexpr const char* hdf5_name = "results.h5";
constexpr const char* picture_name = "results.svg";  ///< in the place of a report

/// results.h5 with what is known of a run before it begins.
std::unique_ptr<Hdf5Recorder> begun_hdf5(const std::filesystem::path& folder, const study::Prepared& prepared,
                                         const Provenance& provenance) {
  auto file = make_hdf5_recorder(folder / hdf5_name);
  file->describe("scene", prepared.values.text());
  file->describe("formulation", prepared.scene.formulation_name);
  file->describe("integrator", prepared.scene.integrator_name);
  file->describe("provenance", json_text(provenance_json(provenance)));
  return file;
}

/// Between the parts of a run, each of which needs memory of its own, gives back to the system what the last has freed.
void give_back_memory(const Model& model) {
#if defined(__GLIBC__)
  constexpr std::size_t large = 1000;  // below there is nothing worth the call
  if (model.layout().speeds > large) ::malloc_trim(0);
#else
  static_cast<void>(model);
#endif
}

/// Writes the content of run.json. \returns it in one line: of a large model that is smaller than the JSON.
std::string write_summary(const study::Prepared& prepared, const Provenance& provenance, const RecordedRun& ended,
                          OutputFile& file) {
  nlohmann::ordered_json json = run_json(prepared.scene, ended.run.summary, ended.run.certificate);
  if (!ended.outputs.is_null()) json["outputs"] = ended.outputs;
  json.update(provenance_json(provenance));
  file.write(json_text(json));
  return page_json(json);
}

/// What is known when it has ended.
void describe_end(const study::Prepared& prepared, const study::CertifiedRun& ended, const std::string& run,
                  Hdf5Recorder& file) {
  file.describe("certificate", certificate_text(prepared.model(), ended.summary, ended.certificate));
  file.describe("status", std::string(name(ended.summary.status)));
  file.describe("run", run);
}

RecordedRun simulate_into(CsvRecorder& csv, const std::filesystem::path& folder, const study::Prepared& prepared,
                          Registry& registry, const Provenance& provenance, study::RunSettings settings,
                          RunFiles files) {
  for (const char* old : {summary_name, report_name, picture_name, hdf5_name}) std::filesystem::remove(folder / old);
  RunReport report(prepared);
  if (settings.resume != nullptr) read_csv(folder / table_name, report.table());
  std::vector<Recorder*> all = {&csv, &report.table()};
  auto hdf5 = files.hdf5 ? begun_hdf5(folder, prepared, provenance) : nullptr;
  if (hdf5 != nullptr) all.push_back(hdf5.get());
  SharedRecorder recorders(all);
  std::optional<RunTable> table(std::in_place, prepared, recorders);
  if (hdf5 != nullptr) hdf5->describe_frames(table->frames());
  // An HDF5 file cannot be cut off at a mark: it is written anew.
  if (hdf5 != nullptr && settings.resume != nullptr) read_csv(folder / table_name, *hdf5);
  // What a checkpoint says is done can be read from every file.
  if (hdf5 != nullptr && settings.checkpoint) {
    settings.checkpoint = [&hdf5, keep = settings.checkpoint](const Checkpoint& checkpoint) {
      static_cast<void>(hdf5->mark());
      keep(checkpoint);
    };
  }
  const bool seen = !prepared.escalates();
  if (seen) settings.seen = &table->seen();
  settings.output = [&table, seen, also = settings.output](const State& state, std::size_t rung) {
    if (seen) {
      table->add_seen(state);
    } else {
      table->add(state, rung);
    }
    if (also) also(state, rung);
  };
  RecordedRun recorded;
  std::vector<OutputStatistics> statistics;
  settings.statistics = &statistics;
  recorded.run = study::run(prepared, registry, settings);
  table->note_blanks(recorded.run.summary);
  table.reset();  // of a large model what comes is as large
  give_back_memory(prepared.model());
  if (!statistics.empty()) recorded.outputs = statistics_json(statistics);
  std::string summary;
  // The file has its name once all tables are written.
  write_file(folder / summary_name, [&](OutputFile& file) {
    summary = write_summary(prepared, provenance, recorded, file);
    if (hdf5 != nullptr) describe_end(prepared, recorded.run, summary, *hdf5);
    recorders.end();
    hdf5.reset();
  });
  give_back_memory(prepared.model());
  if (has_report_page()) {
    write_report(folder / report_name, prepared.title(),
                 [&](const TextSink& write) { report.write(recorded.run, summary, write); });
  } else {
    write_file(folder / picture_name, report.picture());
  }
  return recorded;
}

}  // namespace

RunTable::RunTable(const study::Prepared& prepared, Recorder& recorder)
    : recorder_(recorder), columns_(columns_of_rungs(prepared)) {
  recorder_.begin(columns_.front().columns());
}

void RunTable::note_blanks(RunSummary& summary) const {
  std::vector<std::size_t> rows;
  for (const ResultColumns& columns : columns_) {
    rows.resize(std::max(rows.size(), columns.nonfinite().size()));
    for (std::size_t i = 0; i < columns.nonfinite().size(); ++i) rows[i] += columns.nonfinite()[i];
  }
  if (std::all_of(rows.begin(), rows.end(), [](std::size_t n) { return n == 0; })) return;
  const std::vector<Column>& all = columns_.front().columns();
  std::string list;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] > 0)
      list += fmt::format("{}'{}' in {}", list.empty() ? "" : ", ", all[all.size() - rows.size() + i].name, rows[i]);
  summary.message += fmt::format("{}Outputs gave no finite number in rows of the table: {} of them.",
                                 summary.message.empty() ? "" : " ", list);
}

std::vector<std::string> run_content() {
  return {table_name,  summary_name, "checkpoint.cbor", "checkpoint.previous.cbor",
          report_name, picture_name, hdf5_name};
}

RecordedRun record_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                       const Provenance& provenance, study::RunSettings settings, RunFiles files) {
  make_folder(folder);
  CsvRecorder csv(folder / table_name);
  return simulate_into(csv, folder, prepared, registry, provenance, std::move(settings), files);
}

RecordedRun record_lasting_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                               const Provenance& provenance, study::RunSettings settings, const StoredRun* from,
                               RunFiles files) {
  const CheckpointFiles checkpoints(folder, provenance.fingerprint());
  std::optional<CsvRecorder> csv;
  if (from != nullptr) {
    csv.emplace(folder / table_name, from->table);
    settings.resume = &from->checkpoint;
  } else {
    csv.emplace(folder / table_name);
  }
  settings.checkpoint = [&](const Checkpoint& checkpoint) { checkpoints.write({checkpoint, csv->mark(), {}}); };
  RecordedRun recorded = simulate_into(*csv, folder, prepared, registry, provenance, std::move(settings), files);
  if (recorded.run.summary.status != RunStatus::interrupted) checkpoints.remove();
  return recorded;
}

RecordedRun begin_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                      const Provenance& provenance, const study::RunSettings& settings, RunFiles files, FolderUse use) {
  const ResultsFolder taken(folder, "run", provenance, run_content(), use);
  return record_lasting_run(folder, prepared, registry, provenance, settings, nullptr, files);
}

RecordedRun resume_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                       const Provenance& provenance, const study::RunSettings& settings, RunFiles files,
                       const std::function<void(std::string_view)>& remark) {
  refuse_busy(folder);  // its run may not have come to a checkpoint yet
  const CheckpointFiles checkpoints(folder, provenance.fingerprint());
  if (!checkpoints.exist()) throw ResultsError(folder.string() + " holds no checkpoint: there is nothing to resume");
  const ResultsFolder taken(folder, "run", provenance, run_content(), FolderUse::go_on);
  if (!taken.changed().empty())
    throw ResultsError(folder.string() + " belongs to another run: " + taken.changed() +
                       " changed since; run without --resume to begin anew");
  const StoredRun from = checkpoints.read();
  if (!from.remark.empty()) remark(from.remark);
  return record_lasting_run(folder, prepared, registry, provenance, settings, &from, files);
}

}  // namespace withy
