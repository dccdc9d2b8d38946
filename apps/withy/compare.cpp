#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/formulation_words.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/variation.hpp"
#include "withy/results/comparison_picture.hpp"
#include "withy/results/comparison_report.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/motion_picture.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/unfit.hpp"

namespace withy::app {
namespace {

struct CompareArguments : SceneArguments, OutputArguments {
  std::vector<std::string> formulations;  ///< empty: the usual ones that can treat the scene
  std::vector<std::string> outputs;       ///< that errors are measured on; empty: all of the usual ones
  std::string reference = "quadratic";    ///< formulation that the others' errors are measured against
  std::string over;  ///< `path=value,value,…`: the comparison is made at each value; may be empty
};

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

const std::vector<std::string> usual_formulations = {"ruthless", "inconsistent", "consistent", "quadratic"};

/// The runs at one value, and where they are kept.
struct Group : ComparisonAt {
  fs::path folder;                   ///< empty: nowhere
  std::vector<std::string> reports;  ///< parts of a page, one a run
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
    for (const char* name : {"compare.svg", "motion.svg", report_name}) names.push_back((folder / name).string());
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
  Group group{{value, {}}, arguments.out.empty() ? "" : fs::path(arguments.out) / below(path, value), {}};
  SceneValues values = read_values(arguments);
  if (!path.empty()) values.set_text(path + '=' + value);
  const auto simulator = [&](const study::Prepared& prepared, const std::function<void(const State&)>& output) {
    const std::string& formulation = prepared.scene.formulation_name;
    if (group.folder.empty()) return study::simulate(prepared, registry, output, run_control(formulation));
    study::RunSettings settings;
    settings.look_beyond = false;
    settings.control = run_control(formulation);
    settings.output = [&](const State& state, std::size_t) { output(state); };
    RecordedRun recorded =
        record_run(group.folder / formulation, prepared, registry, provenance_of(prepared.scene, plugins), settings);
    group.reports.push_back(std::move(recorded.report));
    return recorded.run.summary;
  };
  group.comparison =
      study::compare(values, registry, arguments.formulations, arguments.reference, simulator, arguments.outputs);
  return group;
}

void write_picture(const Group& group, const std::string& label) {
  const study::Comparison& c = group.comparison;
  std::string title = c.runs.front().prepared.title();
  if (!label.empty()) title += ", " + label + " = " + group.value;
  write_file(group.folder / "compare.svg", comparison_picture(title, c));
  write_file(group.folder / "motion.svg", motion_picture(title, c));
  if (!has_report_page()) return;
  write_report(group.folder / report_name,
               {title, group.reports, c.has_reference() ? static_cast<int>(c.reference) : -1});
}

std::string left_out_text(const std::vector<study::Unfit>& left_out) {
  std::string text;
  for (const study::Unfit& l : left_out) text += "\nleft out " + l.formulation + ": " + l.reason + '\n';
  return text;
}

Json left_out_json(const std::vector<study::Unfit>& left_out) {
  Json list = Json::array();
  for (const study::Unfit& l : left_out) list.push_back({{"formulation", l.formulation}, {"reason", l.reason}});
  return list;
}

ExitStatus compare(CompareArguments arguments) {
  const study::Variation variation =
      arguments.over.empty() ? study::Variation{"", {""}} : parse_variation(arguments.over);
  const std::string label = label_of(variation.path);
  const Plugins plugins(arguments);
  std::vector<study::Unfit> left_out;
  if (arguments.formulations.empty()) {
    arguments.formulations = usual_formulations;
    left_out = study::take_out_unfit(make_scene(read_values(arguments), plugins.registry()).model, plugins.registry(),
                                     arguments.formulations);
  }
  const auto folder =
      take_folder(arguments, "compare", provenance_of(make_scene(read_values(arguments), plugins.registry()), plugins),
                  content_of(arguments, variation));
  std::vector<ComparisonAt> groups;
  bool interrupted = false;
  for (const std::string& value : variation.values) {
    Group group = group_at(arguments, plugins, variation.path, value);
    if (!group.folder.empty()) write_picture(group, label);
    interrupted = group.comparison.interrupted();
    groups.push_back(std::move(group));
    if (interrupted) break;
  }
  const Scene& scene = groups.front().comparison.runs.front().prepared.scene;
  Json j{{"scene", scene.file}, {"name", scene.name}, {"reference", arguments.reference}};
  if (!label.empty()) j["over"] = variation.path;
  if (!left_out.empty()) j["left_out"] = left_out_json(left_out);
  j["runs"] = Json::array();
  for (const ComparisonAt& group : groups)
    for (Json& run : comparison_json(group, plugins.registry(), !label.empty())) j["runs"].push_back(std::move(run));

  std::string text = arguments.json
                         ? json_text(j)
                         : comparison_text(groups, arguments.reference, label) +
                               formulation_words(arguments.formulations, plugins.registry()) + left_out_text(left_out);
  if (!arguments.out.empty()) {
    write_file(fs::path(arguments.out) / "compare.json", json_text(j));
    if (!arguments.json)
      text += std::string("\nresults and pictures (") + (has_report_page() ? "report.html" : "compare.svg") + ") in " +
              arguments.out + '\n';
  }
  print(text);
  return interrupted ? ExitStatus::interrupted : ExitStatus::done;
}

std::function<ExitStatus()> add_compare(CLI::App& c) {
  const auto arguments = std::make_shared<CompareArguments>();
  CompareArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.formulations, "--formulations,--formulation",
                   "Formulations; default: those of ruthless,inconsistent,consistent,quadratic that can treat the "
                   "scene");
  c.add_option("--reference", a.reference, "Formulation the errors are measured against")
      ->type_name("ID")
      ->capture_default_str();
  c.add_option("--outputs,--output", a.outputs,
               "What errors are shown of, each beside its range: hinges, tips, outputs of the scene (root, root.mz)")
      ->type_name("NAME,...")
      ->delimiter(',');
  c.add_option("--over", a.over, "Compare at each of these values of the scene")->type_name("PATH=VALUE,VALUE,...");
  add_output(c, a, "Folder for results and pictures; default: nothing is kept");
  return [arguments] { return compare(*arguments); };
}

}  // namespace

const Command compare_command = {"compare", "Simulate a scene in several formulations, side by side",
                                 "  withy compare scenes/two-link-slew.yaml\n"
                                 "  withy compare scenes/loads-of-the-slew.yaml --formulations quadratic,linear "
                                 "--reference exact --output root.mz,elbow_load.fx\n"
                                 "  withy compare scenes/two-link-slew.yaml --formulations ruthless,quadratic "
                                 "--over loads.slew.time_scale=1.0,1.2 --out results/comparison",
                                 &add_compare};

}  // namespace withy::app
