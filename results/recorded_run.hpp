/// \file
/// Runs that leave a folder behind: results.csv as they go (and results.h5), run.json and report.html when they have
/// ended.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "withy/results/checkpoint_files.hpp"
#include "withy/results/provenance.hpp"
#include "withy/results/recorder.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/study/run.hpp"

namespace withy {

/// The rows of a run. Tips and energies are those of the formulation that the run is in.
class RunTable {
 public:
  /// Both must outlive it. Begins the recorder's table.
  RunTable(const study::Prepared& prepared, Recorder& recorder);
  void add(const State& state, std::size_t rung) { recorder_.row(columns_[rung].row(state)); }
  /// The same of the first formulation, where `seen()` is at that state.
  void add_seen(const State& state) { recorder_.row(columns_.front().row_of_seen(state)); }
  /// Axes of each column, ResultColumns::frames.
  [[nodiscard]] const std::vector<std::string>& frames() const { return columns_.front().frames(); }
  /// For RunSettings::seen: a row then costs no pass of its own.
  [[nodiscard]] Observation& seen() { return columns_.front().seen(); }
  /// Adds to what the summary says which outputs had no finite number in how many of the rows; nothing where all had.
  void note_blanks(RunSummary& summary) const;

 private:
  Recorder& recorder_;
  std::vector<ResultColumns> columns_;
};

struct RecordedRun {
  study::CertifiedRun run;
  nlohmann::ordered_json outputs;  ///< the statistics in run.json; null where the scene asks for none
};

/// What a run writes beside what every run does.
struct RunFiles {
  bool hdf5 = false;  ///< results.h5, too
};

/// What a run leaves in its folder, checkpoints included.
std::vector<std::string> run_content();

/// Simulates into a folder, made where it is not there; a folder without run.json is a run that was killed.
/// `settings.output` sees every output too. \throws std::system_error where something cannot be written.
RecordedRun record_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                       const Provenance& provenance, study::RunSettings settings, RunFiles files = {});

/// The same with checkpoints in the folder every `settings.checkpoint_seconds`, and where the run is interrupted; they
/// are removed when it has ended. \param from where to go on; null: it begins
RecordedRun record_lasting_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                               const Provenance& provenance, study::RunSettings settings, const StoredRun* from,
                               RunFiles files = {});

/// A whole run: takes the folder, and begins. \throws ResultsError, FolderBusy as ResultsFolder; std::system_error
RecordedRun begin_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                      const Provenance& provenance, const study::RunSettings& settings, RunFiles files, FolderUse use);
/// Goes on from the newest sound checkpoint in the folder. \param remark is told where that is not the newest
/// \throws ResultsError where there is none, or the folder is another run's; FolderBusy, whether there is one or not
RecordedRun resume_run(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                       const Provenance& provenance, const study::RunSettings& settings, RunFiles files,
                       const std::function<void(std::string_view)>& remark);

}  // namespace withy
