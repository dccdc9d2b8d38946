#include "withy/apps/withy/results.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/columns.hpp"
#include "withy/apps/withy/json_text.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/run_report.hpp"

namespace withy::app {

RunSummary simulate_into(const std::filesystem::path& folder, const Engine& engine,
                         const std::function<void(const State&)>& also) {
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / "run.json");
  const ResultColumns columns(engine.model(), engine.equations());
  OutputFile csv(folder / "results.csv");
  csv.write(csv_head(columns.columns()));
  const RunSummary summary = engine.simulate([&](const State& state) {
    csv.write(csv_line(columns.row(state)));
    if (also) also(state);
  });
  csv.close();
  write_file(folder / "run.json", json_text(run_json(engine, summary)));
  return summary;
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
