#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/comparison.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/apps/withy/variation.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// The runs at one value, and where they are kept.
struct Group {
  std::string value;
  fs::path folder;  ///< empty: nowhere
  std::vector<ComparedRun> runs;
  std::size_t listed = 0;     ///< runs beyond these were made for reference only
  std::size_t reference = 0;  ///< index

  [[nodiscard]] std::string title(const Variation& v) const {
    const Scene& scene = runs.front().engine->scene();
    const std::string name = scene.name.empty() ? scene.file : scene.name;
    return v.none() ? name : name + ", " + v.label() + " = " + value;
  }
};

ComparedRun simulate_one(SceneArguments arguments, const std::string& formulation, const fs::path& folder) {
  arguments.options.formulation = formulation;
  ComparedRun run;
  run.engine = std::make_unique<Engine>(arguments);
  const auto keep = [&](const State& s) { run.outputs.push_back(s); };
  run.summary = folder.empty() ? run.engine->simulate(keep) : simulate_into(folder / formulation, *run.engine, keep);
  return run;
}

/// Runs every formulation at one value; stops early where the user interrupts.
Group simulate_group(const CompareArguments& arguments, const Variation& variation, const std::string& value) {
  Group group;
  group.value = value;
  if (!arguments.out.empty()) {
    std::string name = variation.label() + '=' + value;
    std::replace(name.begin(), name.end(), '/', '_');
    group.folder = variation.none() ? fs::path(arguments.out) : fs::path(arguments.out) / name;
  }
  SceneArguments scene = arguments;
  if (!variation.none()) scene.options.overrides.push_back(variation.path + '=' + value);
  std::vector<std::string> formulations = arguments.formulations;
  group.listed = formulations.size();
  const auto found = std::find(formulations.begin(), formulations.end(), arguments.reference);
  group.reference = static_cast<std::size_t>(found - formulations.begin());
  if (found == formulations.end()) formulations.push_back(arguments.reference);
  for (const std::string& f : formulations) {
    group.runs.push_back(simulate_one(scene, f, group.folder));
    if (group.runs.back().summary.status == RunStatus::interrupted) break;
  }
  group.listed = std::min(group.listed, group.runs.size());
  return group;
}

bool interrupted(const Group& group) { return group.runs.back().summary.status == RunStatus::interrupted; }

/// Hinges with one coordinate and beams have columns of their own.
TextTable table_for(const Model& model, const RunSummary& summary, const Variation& variation) {
  std::vector<std::string> head = {"<formulation"};
  if (!variation.none()) head.push_back(variation.label());
  head.push_back("<outcome");
  for (const HingeNode& h : model.hinges()) {
    const auto columns = coordinate_columns(h);
    if (columns.size() != 1) continue;
    head.push_back(fmt::format("{}\n[{}]", h.name, columns[0].unit == "rad" ? "deg" : columns[0].unit));
  }
  for (const auto& [body, peak] : summary.peak_deflection) head.push_back("peak " + body + "\n[mm]");
  for (const char* text : {"evaluations", "CPU\n[ms]", "hinge\nerror", "tip error\n[mm]"}) head.emplace_back(text);
  return TextTable(head);
}

void add_row(TextTable& table, const Group& group, const ComparedRun& run, const Variation& variation) {
  const Model& model = run.engine->model();
  const RunSummary& s = run.summary;
  std::vector<std::string> row = {run.formulation()};
  if (!variation.none()) row.push_back(group.value);
  row.push_back(outcome_text(s));
  const bool completed = s.status == RunStatus::completed;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const auto columns = coordinate_columns(model.hinges()[h]);
    if (columns.size() != 1) continue;
    const double x = s.final.y[model.layout().hinges[h].position];
    const double shown = columns[0].unit == "rad" ? x * 180 / std::numbers::pi : x;
    row.push_back(completed ? fmt::format("{:.4f}", shown) : "-");
  }
  for (const auto& [body, d] : s.peak_deflection)
    row.push_back(completed ? fmt::format("{:.3f}", 1e3 * std::hypot(d[1], d[2])) : "-");
  row.push_back(std::to_string(s.steps.evaluations));
  row.push_back(fmt::format("{:.2f}", 1e3 * s.cpu_seconds));
  if (group.reference < group.runs.size() && &run != &group.runs[group.reference]) {
    const Distances d = distances(run, group.runs[group.reference]);
    row.push_back(fmt::format("{:.2g}", d.greatest_hinge()));
    row.push_back(fmt::format("{:.3g}", 1e3 * d.greatest_tip()));
  } else {
    row.insert(row.end(), 2, "-");
  }
  table.add(std::move(row));
}

Json group_json(const Group& group, const Variation& variation) {
  Json runs = Json::array();
  for (const ComparedRun& run : group.runs) {
    Json j;
    if (!variation.none()) j["value"] = group.value;
    j.update(run_json(*run.engine, run.summary));
    if (group.reference < group.runs.size()) {
      const Distances d = distances(run, group.runs[group.reference]);
      j["distance"] = {{"hinges", d.hinges}, {"tips", d.tips}, {"until", d.until}};
    }
    runs.push_back(std::move(j));
  }
  return runs;
}

std::string table_text(const std::vector<Group>& groups, const CompareArguments& arguments,
                       const Variation& variation) {
  const ComparedRun& first = groups.front().runs.front();
  TextTable table = table_for(first.engine->model(), first.summary, variation);
  std::string reasons;
  for (const Group& group : groups) {
    for (std::size_t i = 0; i < group.listed; ++i) {
      const ComparedRun& run = group.runs[i];
      add_row(table, group, run, variation);
      if (run.summary.status == RunStatus::completed) continue;
      reasons +=
          fmt::format("\n{}{}: {}\n", run.formulation(),
                      variation.none() ? "" : " at " + variation.label() + " " + group.value, run.summary.message);
    }
  }
  const Scene& scene = first.engine->scene();
  return fmt::format(
      "{} ({})\n\n{}\nErrors are greatest distances from {}, in rad or m of hinges and mm of tips, "
      "while both ran.\n{}",
      scene.name.empty() ? scene.file : scene.name, scene.integrator_name, table.str(), arguments.reference, reasons);
}

}  // namespace

ExitStatus compare(const CompareArguments& arguments) {
  const Variation variation = parse_variation(arguments.over);
  std::vector<Group> groups;
  for (const std::string& value : variation.values) {
    groups.push_back(simulate_group(arguments, variation, value));
    const Group& group = groups.back();
    if (!group.folder.empty()) {
      std::vector<const ComparedRun*> shown;
      for (std::size_t i = 0; i < group.listed; ++i) shown.push_back(&group.runs[i]);
      write_file(group.folder / "compare.svg", picture(group.title(variation), shown));
    }
    if (interrupted(group)) break;
  }

  const Scene& scene = groups.front().runs.front().engine->scene();
  Json j{{"scene", scene.file}, {"name", scene.name}, {"reference", arguments.reference}};
  if (!variation.none()) j["over"] = variation.path;
  j["runs"] = Json::array();
  for (const Group& group : groups)
    for (Json& run : group_json(group, variation)) j["runs"].push_back(std::move(run));

  std::string text = arguments.json ? json_text(j) : table_text(groups, arguments, variation);
  if (!arguments.out.empty()) {
    write_file(fs::path(arguments.out) / "compare.json", json_text(j));
    if (!arguments.json) text += "\nresults and pictures (compare.svg) in " + arguments.out + '\n';
  }
  print(text);
  return interrupted(groups.back()) ? ExitStatus::interrupted : ExitStatus::done;
}

}  // namespace withy::app
