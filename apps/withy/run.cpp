#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/json_text.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"

namespace withy::app {

ExitStatus run(const RunArguments& arguments) {
  const Engine engine(arguments);
  std::filesystem::path folder = arguments.out;
  if (folder.empty()) {
    folder = std::filesystem::path("results") /
             (std::filesystem::path(arguments.scene).stem().string() + '-' + engine.scene().formulation_name);
  }
  const CertifiedRun certified = run_into(folder, engine, arguments);
  const RunSummary& summary = certified.summary;
  print(arguments.json ? json_text(run_json(engine, summary, certified.evidence()))
                       : run_table(engine, summary) + certificate_text(engine, summary, certified.evidence()) +
                             "\nresults in " + folder.string() + '\n');
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  if (summary.status == RunStatus::interrupted) complain("the same command with --resume goes on from there");
  return exit_status(summary.status);
}

}  // namespace withy::app
