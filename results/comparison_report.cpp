#include "withy/results/comparison_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/core/model/columns.hpp"
#include "withy/results/certificate_json.hpp"
#include "withy/results/run_text.hpp"
#include "withy/results/text_table.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

using OutputErrors = std::vector<study::Comparison::OutputError>;

/// "0.0123 of 4.5": the distance and the range.
std::string error_text(const study::Comparison::OutputError& o) {
  return fmt::format("{:.3g} of {:.3g}", o.distance, o.range);
}

/// \param outputs that errors are asked of by name
TextTable table_for(const Model& model, const RunSummary& summary, const std::string& label,
                    const OutputErrors& outputs) {
  std::vector<std::string> head = {"<formulation"};
  if (!label.empty()) head.push_back(label);
  head.push_back("<outcome");
  for (const HingeNode& h : model.hinges()) {
    const auto columns = coordinate_columns(h);
    if (columns.size() != 1) continue;
    head.push_back(fmt::format("{}\n[{}]", h.name, columns[0].unit == "rad" ? "deg" : columns[0].unit));
  }
  for (const auto& [body, peak] : summary.peak_deflection) head.push_back("peak " + body + "\n[mm]");
  for (const char* text : {"evaluations", "CPU\n[ms]"}) head.emplace_back(text);
  if (outputs.empty())
    for (const char* text : {"hinge\nerror", "tip error\n[mm]"}) head.emplace_back(text);
  for (const auto& o : outputs) head.push_back(o.label + fmt::format("\n[{}]", o.unit));
  return TextTable(head);
}

void add_row(TextTable& table, const ComparisonAt& group, const study::ComparedRun& run, const std::string& label) {
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
    row.push_back(!completed ? "-" : columns[0].unit == "rad" ? degrees_text(x) : to_four_places(x));
  }
  for (const auto& [body, d] : s.peak_deflection)
    row.push_back(completed ? fmt::format("{:.3f}", 1e3 * std::hypot(d[1], d[2])) : "-");
  row.push_back(std::to_string(s.steps.evaluations));
  row.push_back(fmt::format("{:.2f}", 1e3 * s.cpu_seconds));
  const study::Comparison& c = group.comparison;
  const bool apart = c.has_distances(run) && &run != &c.runs[c.reference];
  if (!c.outputs.empty()) {
    for (const auto& o : c.has_reference() ? c.output_errors(run) : OutputErrors())
      row.push_back(apart ? error_text(o) : "-");
  } else if (apart) {
    const study::NamedDistances d = c.distances(run);
    row.push_back(fmt::format("{:.2g}", d.greatest_hinge()));
    row.push_back(fmt::format("{:.3g}", 1e3 * d.greatest_tip()));
  } else {
    row.insert(row.end(), 2, "-");
  }
  table.add(std::move(row));
}

/// Why a run has no errors; empty where it has some.
std::string no_errors_text(const study::Comparison& c, const study::ComparedRun& run) {
  if (!c.has_reference() || c.has_distances(run)) return "";
  return fmt::format(
      "No errors: it and the reference have no output in common but the start; it ended at {:.4g} s, the reference at "
      "{:.4g} s, and outputs are {:.4g} s apart. More of them, as --set time.output={:.2g}, tell.",
      run.summary.reached, c.runs[c.reference].summary.reached, run.prepared.scene.output,
      std::min(run.summary.reached, c.runs[c.reference].summary.reached) / 20);
}

/// \param varied the value is written, too
void add_runs(Json& runs, const ComparisonAt& group, bool varied, Registry& registry) {
  for (const study::ComparedRun& run : group.comparison.runs) {
    Json j;
    if (varied) j["value"] = group.value;
    j.update(run_json(run.prepared.scene, run.summary,
                      study::certify(run.prepared, {&run.summary, nullptr, {}, {}}, registry)));
    if (group.comparison.has_reference()) {
      // At the start all are alike: a run that has nothing more in common with the reference has no distances.
      const bool measured = group.comparison.has_distances(run);
      const study::NamedDistances d = measured ? group.comparison.distances(run) : study::NamedDistances();
      j["distance"] = named_distances_json(d);
      j["distance"]["until"] = d.until;
      if (!group.comparison.outputs.empty()) j["outputs"] = Json::array();
      for (const auto& o : measured ? group.comparison.output_errors(run) : OutputErrors())
        j["outputs"].push_back({{"output", o.label}, {"unit", o.unit}, {"distance", o.distance}, {"range", o.range}});
    }
    runs.push_back(std::move(j));
  }
}

}  // namespace

Json comparison_json(const std::vector<ComparisonAt>& groups, const std::string& reference, const std::string& over,
                     const std::vector<study::Unfit>& left_out, Registry& registry) {
  const Scene& scene = groups.front().comparison.runs.front().prepared.scene;
  Json j{{"scene", scene.file}, {"name", scene.name}, {"reference", reference}};
  if (!over.empty()) j["over"] = over;
  for (const study::Unfit& l : left_out)
    j["left_out"].push_back({{"formulation", l.formulation}, {"reason", l.reason}});
  j["runs"] = Json::array();
  for (const ComparisonAt& group : groups) add_runs(j["runs"], group, !over.empty(), registry);
  return j;
}

std::string comparison_text(const std::vector<ComparisonAt>& groups, const std::string& reference,
                            const std::string& label) {
  const study::ComparedRun& first = groups.front().comparison.runs.front();
  const study::Comparison& comparison = groups.front().comparison;
  TextTable table = table_for(first.prepared.model(), first.summary, label,
                              comparison.has_reference() ? comparison.output_errors(first) : OutputErrors());
  std::string reasons;
  for (const ComparisonAt& group : groups) {
    for (std::size_t i = 0; i < group.comparison.listed; ++i) {
      const study::ComparedRun& run = group.comparison.runs[i];
      add_row(table, group, run, label);
      const bool ended_early = run.summary.status != RunStatus::completed || run.summary.ended_by_event;
      std::string why = ended_early ? run.summary.message : "";
      if (const std::string none = no_errors_text(group.comparison, run); !none.empty())
        why += (why.empty() ? "" : " ") + none;
      if (why.empty()) continue;
      reasons +=
          fmt::format("\n{}{}: {}\n", run.formulation(), label.empty() ? "" : " at " + label + " " + group.value, why);
    }
  }
  return fmt::format("{} ({})\n\n{}\nErrors are greatest distances from {}, {}, while both ran.\n{}",
                     first.prepared.title(), first.prepared.scene.integrator_name, table.str(), reference,
                     comparison.outputs.empty() ? "in rad or m of hinges and mm of tips"
                                                : "beside how far the reference goes from its start",
                     reasons);
}

std::string left_out_text(const std::vector<study::Unfit>& left_out) {
  std::string text;
  for (const study::Unfit& l : left_out) text += "\nleft out " + l.formulation + ": " + l.reason + '\n';
  return text;
}

}  // namespace withy
