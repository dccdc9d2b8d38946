#include "withy/results/recorded_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "withy/results/comparison_picture.hpp"
#include "withy/results/motion_picture.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/study/variation_text.hpp"

namespace withy {
namespace {

/// The folders of the values in that of the results, no two of one name: "x/a" and "x_a" would be one.
std::vector<std::string> folders_of(const study::Variation& over) {
  if (over.path.empty()) return {""};
  std::vector<std::string> names;
  const auto taken = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const std::string& value : over.values) {
    std::string plain = study::label_of(over.path) + '=' + value;
    std::replace(plain.begin(), plain.end(), '/', '_');
    std::string name = plain;
    for (std::size_t i = 2; taken(name); ++i) name = fmt::format("{}_{}", plain, i);
    names.push_back(std::move(name));
  }
  return names;
}

/// \param reports parts of a page, one a run
void write_pictures(const std::filesystem::path& folder, const ComparisonAt& group, const std::string& label,
                    std::vector<std::string> reports) {
  const study::Comparison& c = group.comparison;
  std::string title = c.runs.front().prepared.title();
  if (!label.empty()) title += ", " + label + " = " + group.value;
  write_file(folder / "compare.svg", comparison_picture(title, c));
  write_file(folder / "motion.svg", motion_picture(title, c));
  if (!has_report_page()) return;
  write_report(folder / report_name,
               {title, std::move(reports), c.has_reference() ? static_cast<int>(c.reference) : -1});
}

}  // namespace

std::vector<std::string> comparison_content(const ComparisonQuestion& question) {
  std::vector<std::string> names = {"compare.json"};
  for (const std::filesystem::path folder : folders_of(question.over)) {
    for (const char* name : {"compare.svg", "motion.svg", report_name}) names.push_back((folder / name).string());
    std::vector<std::string> formulations = question.formulations;
    formulations.push_back(question.reference);
    for (const std::string& formulation : formulations)
      for (const std::string& name : run_content()) names.push_back((folder / formulation / name).string());
  }
  return names;
}

std::string comparison_places(const std::filesystem::path& folder, const study::Variation& over) {
  const char* page = has_report_page() ? report_name : "compare.svg";
  const std::string first = (folder / folders_of(over).front() / page).string();
  const std::size_t more = over.values.size() - 1;
  return fmt::format("\nresults in {}, to look at in {}{}\n", folder.string(), first,
                     more == 0 ? "" : fmt::format(" and those beside it, one a value of {}", over.path));
}

std::vector<ComparisonAt> record_comparison(const std::filesystem::path& folder, const SceneValues& values,
                                            Registry& registry, const ComparisonQuestion& question,
                                            const std::function<Provenance(const Scene&)>& provenance,
                                            const std::function<study::Control(const std::string&)>& control) {
  std::vector<ComparisonAt> groups;
  const std::vector<std::string> folders = folders_of(question.over);
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const std::string& value = question.over.values[i];
    SceneValues varied = values;
    if (!question.over.path.empty()) varied.set_text(question.over.path + '=' + value);
    const std::filesystem::path own = folder / folders[i];
    std::vector<std::string> reports;
    const auto simulator = [&](const study::Prepared& prepared, const std::function<void(const State&)>& output) {
      const std::string& formulation = prepared.scene.formulation_name;
      if (folder.empty()) return study::simulate(prepared, registry, output, control(formulation));
      study::RunSettings settings;
      settings.look_beyond = false;
      settings.control = control(formulation);
      settings.output = [&](const State& state, std::size_t) { output(state); };
      RecordedRun recorded = record_run(own / formulation, prepared, registry, provenance(prepared.scene), settings);
      if (has_report_page()) reports.push_back(std::move(read_report(own / formulation / report_name).front()));
      return recorded.run.summary;
    };
    groups.push_back({value, study::compare(varied, registry, question.formulations, question.reference, simulator,
                                            question.outputs)});
    if (!folder.empty()) write_pictures(own, groups.back(), study::label_of(question.over.path), std::move(reports));
    if (groups.back().comparison.interrupted()) break;
  }
  return groups;
}

}  // namespace withy
