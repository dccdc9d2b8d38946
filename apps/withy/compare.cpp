#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/apps/withy/variation.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/results/certificate_json.hpp"
#include "withy/results/comparison_picture.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/study/comparison.hpp"

namespace withy::app {
namespace {

struct CompareArguments : SceneArguments, OutputArguments {
  std::vector<std::string> formulations = {"ruthless", "inconsistent", "consistent", "quadratic"};
  std::string reference = "quadratic";  ///< formulation that the others' errors are measured against
  std::string over;                     ///< `path=value,value,…`: the comparison is made at each value; may be empty
};

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// The runs at one value, and where they are kept.
struct Group {
  std::string value;  ///< empty where none is gone over
  fs::path folder;    ///< empty: nowhere
  study::Comparison comparison;
};

/// The folder of one value in that of the results.
std::string below(const std::string& path, const std::string& value) {
  if (path.empty()) return {};
  std::string name = label_of(path) + '=' + value;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

/// What the comparison leaves in its folder.
std::vector<std::string> content_of(const CompareArguments& arguments, const study::Variation& variation) {
  std::vector<std::string> names = {"compare.json"};
  for (const std::string& value : variation.values) {
    const fs::path folder = below(variation.path, value);
    names.push_back((folder / "compare.svg").string());
    std::vector<std::string> formulations = arguments.formulations;
    formulations.push_back(arguments.reference);
    for (const std::string& formulation : formulations)
      for (const std::string& name : run_content()) names.push_back((folder / formulation / name).string());
  }
  return names;
}

/// The comparison at one value of what is gone over; at the scene's own where `path` is empty.
Group group_at(const CompareArguments& arguments, const Plugins& plugins, const std::string& path,
               const std::string& value) {
  Registry& registry = plugins.registry();
  Group group{value, arguments.out.empty() ? "" : fs::path(arguments.out) / below(path, value), {}};
  SceneValues values = read_values(arguments);
  if (!path.empty()) values.set_text(path + '=' + value);
  const auto simulator = [&](const study::Prepared& prepared, const std::function<void(const State&)>& output) {
    const std::string& formulation = prepared.scene.formulation_name;
    if (group.folder.empty()) return study::simulate(prepared, output, run_control(formulation));
    study::RunSettings settings;
    settings.look_beyond = false;
    settings.control = run_control(formulation);
    settings.output = [&](const State& state, std::size_t) { output(state); };
    return record_run(group.folder / formulation, prepared, registry, provenance_of(prepared.scene, plugins), settings)
        .run.summary;
  };
  group.comparison = study::compare(values, registry, arguments.formulations, arguments.reference, simulator);
  return group;
}

void write_picture(const Group& group, const std::string& label) {
  const study::Comparison& c = group.comparison;
  std::vector<const study::ComparedRun*> shown;
  for (std::size_t i = 0; i < c.listed; ++i) shown.push_back(&c.runs[i]);
  std::string title = c.runs.front().prepared.title();
  if (!label.empty()) title += ", " + label + " = " + group.value;
  write_file(group.folder / "compare.svg", comparison_picture(title, shown));
}

TextTable table_for(const Model& model, const RunSummary& summary, const std::string& label) {
  std::vector<std::string> head = {"<formulation"};
  if (!label.empty()) head.push_back(label);
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

void add_row(TextTable& table, const Group& group, const study::ComparedRun& run, const std::string& label) {
  const Model& model = run.prepared.model();
  const RunSummary& s = run.summary;
  std::vector<std::string> row = {run.formulation()};
  if (!label.empty()) row.push_back(group.value);
  row.push_back(study::outcome_text(s));
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
  const study::Comparison& c = group.comparison;
  if (c.has_reference() && &run != &c.runs[c.reference]) {
    const study::NamedDistances d = c.distances(run);
    row.push_back(fmt::format("{:.2g}", d.greatest_hinge()));
    row.push_back(fmt::format("{:.3g}", 1e3 * d.greatest_tip()));
  } else {
    row.insert(row.end(), 2, "-");
  }
  table.add(std::move(row));
}

Json group_json(const Group& group, Registry& registry, bool varied) {
  Json runs = Json::array();
  for (const study::ComparedRun& run : group.comparison.runs) {
    Json j;
    if (varied) j["value"] = group.value;
    j.update(run_json(run.prepared.scene, run.summary,
                      study::certify(run.prepared, {&run.summary, nullptr, nullptr, {}}, registry)));
    if (group.comparison.has_reference()) {
      const study::NamedDistances d = group.comparison.distances(run);
      j["distance"] = {{"hinges", d.hinges},   {"tips", d.tips},     {"deflections", d.deflections},
                       {"moments", d.moments}, {"forces", d.forces}, {"until", d.until}};
    }
    runs.push_back(std::move(j));
  }
  return runs;
}

std::string table_text(const std::vector<Group>& groups, const CompareArguments& arguments, const std::string& label) {
  const study::ComparedRun& first = groups.front().comparison.runs.front();
  TextTable table = table_for(first.prepared.model(), first.summary, label);
  std::string reasons;
  for (const Group& group : groups) {
    for (std::size_t i = 0; i < group.comparison.listed; ++i) {
      const study::ComparedRun& run = group.comparison.runs[i];
      add_row(table, group, run, label);
      if (run.summary.status == RunStatus::completed) continue;
      reasons += fmt::format("\n{}{}: {}\n", run.formulation(), label.empty() ? "" : " at " + label + " " + group.value,
                             run.summary.message);
    }
  }
  return fmt::format(
      "{} ({})\n\n{}\nErrors are greatest distances from {}, in rad or m of hinges and mm of tips, "
      "while both ran.\n{}",
      first.prepared.title(), first.prepared.scene.integrator_name, table.str(), arguments.reference, reasons);
}

ExitStatus compare(const CompareArguments& arguments) {
  const study::Variation variation =
      arguments.over.empty() ? study::Variation{"", {""}} : parse_variation(arguments.over);
  const std::string label = label_of(variation.path);
  const Plugins plugins(arguments);
  const auto folder =
      take_folder(arguments, "compare", provenance_of(make_scene(read_values(arguments), plugins.registry()), plugins),
                  content_of(arguments, variation));
  std::vector<Group> groups;
  for (const std::string& value : variation.values) {
    groups.push_back(group_at(arguments, plugins, variation.path, value));
    if (!groups.back().folder.empty()) write_picture(groups.back(), label);
    if (groups.back().comparison.interrupted()) break;
  }
  const Scene& scene = groups.front().comparison.runs.front().prepared.scene;
  Json j{{"scene", scene.file}, {"name", scene.name}, {"reference", arguments.reference}};
  if (!label.empty()) j["over"] = variation.path;
  j["runs"] = Json::array();
  for (const Group& group : groups)
    for (Json& run : group_json(group, plugins.registry(), !label.empty())) j["runs"].push_back(std::move(run));

  std::string text = arguments.json ? json_text(j) : table_text(groups, arguments, label);
  if (!arguments.out.empty()) {
    write_file(fs::path(arguments.out) / "compare.json", json_text(j));
    if (!arguments.json) text += "\nresults and pictures (compare.svg) in " + arguments.out + '\n';
  }
  print(text);
  return groups.back().comparison.interrupted() ? ExitStatus::interrupted : ExitStatus::done;
}

std::function<ExitStatus()> add_compare(CLI::App& c) {
  const auto arguments = std::make_shared<CompareArguments>();
  CompareArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.formulations, "--formulations,--formulation",
                   "Formulations; default: ruthless,inconsistent,consistent,quadratic");
  c.add_option("--reference", a.reference, "Formulation the errors are measured against")
      ->type_name("ID")
      ->capture_default_str();
  c.add_option("--over", a.over, "Compare at each of these values of the scene")->type_name("PATH=VALUE,VALUE,...");
  add_output(c, a, "Folder for results and pictures; default: nothing is kept");
  return [arguments] { return compare(*arguments); };
}

}  // namespace

const Command compare_command = {"compare", "Simulate a scene in several formulations, side by side",
                                 "  withy compare scenes/two-link-slew.yaml\n"
                                 "  withy compare scenes/two-link-slew.yaml --formulations ruthless,quadratic "
                                 "--over loads.slew.time_scale=1.0,1.2 --out results/comparison",
                                 &add_compare};

}  // namespace withy::app
