#include "withy/apps/withy/results.hpp"

#include <nlohmann/json.hpp>

#include "withy/apps/withy/columns.hpp"
#include "withy/apps/withy/json_text.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/run_report.hpp"

namespace withy::app {

namespace {

/// Everything but run.json.
RunSummary simulate_to_csv(const std::filesystem::path& folder, const Engine& engine, const EquationsOfMotion* beyond,
                           const std::function<void(const State&)>& also) {
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / "run.json");
  const ResultColumns columns(engine.model(), engine.equations());
  OutputFile csv(folder / "results.csv");
  csv.write(csv_head(columns.columns()));
  RunSummary summary = engine.simulate(
      [&](const State& state) {
        csv.write(csv_line(columns.row(state)));
        if (also) also(state);
      },
      beyond);
  csv.close();
  return summary;
}

}  // namespace

RunSummary simulate_into(const std::filesystem::path& folder, const Engine& engine,
                         const std::function<void(const State&)>& also) {
  RunSummary summary = simulate_to_csv(folder, engine, nullptr, also);
  write_file(folder / "run.json", json_text(run_json(engine, summary)));
  return summary;
}

CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments) {
  CertifiedRun run;
  run.beyond = next_model_up(engine, arguments);
  run.summary = simulate_to_csv(folder, engine, run.beyond ? run.beyond->equations.get() : nullptr, {});
  // Against `exact` the estimate costs more than it tells of most runs: on demand.
  const bool wanted = arguments.estimate == "always" ||
                      (arguments.estimate == "auto" && run.beyond && run.beyond->formulation == "quadratic");
  if (wanted && run.beyond && run.summary.status != RunStatus::interrupted)
    run.estimate = estimate_error(engine, *run.beyond, run.summary);
  write_file(folder / "run.json", json_text(run_json(engine, run.summary, run.evidence())));
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
