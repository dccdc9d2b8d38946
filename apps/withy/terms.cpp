#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/terms_files.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/run.hpp"

namespace withy::app {
namespace {

struct TermsArguments : SceneArguments, OutputArguments {};

std::string cell(double value, double greatest) {
  if (!(greatest > 0) || value < 1e-12 * greatest) return "-";
  return fmt::format("{:.3g}", 100 * value / greatest);
}

std::string table_text(const study::TermSizes& ledger) {
  std::vector<std::string> head = {"<term"};
  for (const CoordinateGroup& g : ledger.groups) {
    head.push_back(g.name + "\nrms %");
    head.push_back(g.name + "\npeak %");
  }
  TextTable table(head);
  for (std::size_t k = 0; k < terms_of_motion; ++k) {
    if (ledger.absent(k)) continue;
    std::vector<std::string> row = {std::string(name(static_cast<Term>(k)))};
    for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
      row.push_back(cell(ledger.rms(g, k), ledger.greatest_rms(g)));
      row.push_back(cell(ledger.peak(g, k), ledger.greatest_peak(g)));
    }
    table.add(std::move(row));
  }
  std::string out = table.str() + "\nPer cent of the greatest term on the same coordinates, where it is 100:";
  for (std::size_t g = 0; g < ledger.groups.size(); ++g)
    out += fmt::format("{} {} {:.3g} rms, {:.3g} peak", g > 0 ? ";" : "", ledger.groups[g].name, ledger.greatest_rms(g),
                       ledger.greatest_peak(g));
  return out + " N/sqrt(kg).\n";
}

std::string left_out_text(const study::TermSizes& ledger) {
  if (ledger.left_out.empty()) return {};
  std::vector<std::string> head = {"<formulation"};
  for (const CoordinateGroup& g : ledger.groups) {
    head.push_back(g.name + "\nrms %");
    head.push_back(g.name + "\npeak %");
  }
  TextTable table(head);
  for (const study::LeftOutBy& by : ledger.left_out) {
    std::vector<std::string> row = {by.formulation};
    for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
      row.push_back(cell(by.rms(g), ledger.greatest_rms(g)));
      row.push_back(cell(by.peak(g), ledger.greatest_peak(g)));
    }
    table.add(std::move(row));
  }
  return "\nLeft out by each formulation of what " + ledger.richest + " keeps, in the same per cent:\n\n" + table.str();
}

ExitStatus terms(const TermsArguments& arguments) {
  const Engine engine(arguments);
  const Scene& scene = engine.scene();
  const auto taken = take_folder(arguments, "terms", provenance_of(scene, engine.plugins()),
                                 {"terms.csv", "terms.svg", "terms.json", report_name});
  study::TermStudy study(engine.prepared(), engine.registry());
  const RunSummary summary = study::simulate(
      engine.prepared(), engine.registry(), [&](const State& state) { study.enter(state); },
      run_control(scene.formulation_name));
  const study::TermSizes& sizes = study.sizes();
  const nlohmann::ordered_json j = terms_json(scene, summary, sizes);
  const std::string title = engine.prepared().title();
  std::string text =
      arguments.json ? json_text(j)
                     : fmt::format("{} ({}, {} outputs, {})\n\n{}", title, scene.formulation_name, sizes.times.size(),
                                   study::outcome_text(summary), table_text(sizes) + left_out_text(sizes));
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    write_file(folder / "terms.csv", terms_csv(sizes));
    const Picture picture = terms_picture(title + ": terms along a run of " + scene.formulation_name, sizes);
    write_file(folder / "terms.svg", svg_plot(picture));
    write_figures_page(folder / report_name, picture.title, table_text(sizes) + left_out_text(sizes),
                       {{"", picture.legend, picture.panels}});
    write_file(folder / "terms.json", json_text(j));
    if (!arguments.json) text += "\nreport.html, terms.csv, terms.svg and terms.json in " + folder.string() + '\n';
  }
  print(text);
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  return exit_status(summary.status);
}

std::function<ExitStatus()> add_terms(CLI::App& c) {
  const auto arguments = std::make_shared<TermsArguments>();
  TermsArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_output(c, a, "Folder for table, series and picture; default: nothing is kept");
  return [arguments] { return terms(*arguments); };
}

}  // namespace

const Command terms_command = {"terms", "Measure the terms of the equations of motion along a run",
                               "  withy terms scenes/two-link-slew.yaml\n"
                               "  withy terms scenes/two-link-slew.yaml --formulation ruthless "
                               "--set loads.slew.time_scale=1.2 --out results/terms",
                               &add_terms};

}  // namespace withy::app
