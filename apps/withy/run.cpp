#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

/// Refuses a tolerance below what the mass matrix leaves to be had, and a start at which it is singular.
void check_accuracy(const Engine& engine) {
  const Scene& scene = engine.scene();
  const Value* rtol = scene.source.at("integrator").find("rtol");
  const double tolerance = rtol != nullptr ? rtol->number() : 1.0;
  const std::string why = unattainable(engine.model(), engine.equations(), scene.initial, tolerance);
  if (why.empty()) return;
  throw InputError(rtol != nullptr ? scene.file + ": /integrator/rtol: got " + brief(tolerance) +
                                         ", an accuracy that cannot be had: " + why
                                   : scene.file + ": " + why);
}

}  // namespace

ExitStatus run(const RunArguments& arguments) {
  const Engine engine(arguments);
  if (engine.escalates() && (arguments.resume || arguments.checkpoint))
    throw InputError(std::string(arguments.resume ? "--resume" : "--checkpoint") +
                     ": a run of formulation 'auto' keeps no checkpoints; leave it out, or name a formulation");
  check_accuracy(engine);
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
  if (summary.status == RunStatus::interrupted && !engine.escalates())
    complain("the same command with --resume goes on from there");
  return exit_status(summary.status);
}

}  // namespace withy::app
