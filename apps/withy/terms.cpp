#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/beyond.hpp"
#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/core/analysis/term_ledger.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

Term term(std::size_t k) { return static_cast<Term>(k); }

/// Sizes of all terms over the outputs of a run.
struct Ledger {
  std::vector<CoordinateGroup> groups;
  std::vector<double> times;
  /// [group][term][output]
  std::vector<std::array<std::vector<double>, terms_of_motion>> sizes;

  [[nodiscard]] double rms(std::size_t group, std::size_t k) const {
    double sum = 0;
    for (const double s : sizes[group][k]) sum += s * s;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(times.size(), 1)));
  }
  [[nodiscard]] double peak(std::size_t group, std::size_t k) const {
    double most = 0;
    for (const double s : sizes[group][k]) most = std::max(most, s);
    return most;
  }
  /// Whether a term is nowhere but rounding.
  [[nodiscard]] bool absent(std::size_t k) const {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (peak(g, k) > 1e-12 * greatest_peak(g)) return false;
    }
    return true;
  }
  [[nodiscard]] double greatest_rms(std::size_t group) const {
    double most = 0;
    for (std::size_t k = 0; k < terms_of_motion; ++k) most = std::max(most, rms(group, k));
    return most;
  }
  [[nodiscard]] double greatest_peak(std::size_t group) const {
    double most = 0;
    for (std::size_t k = 0; k < terms_of_motion; ++k) most = std::max(most, peak(group, k));
    return most;
  }
};

/// Follows the run of the engine's own formulation.
class Bookkeeper {
 public:
  Bookkeeper(const Engine& engine, const SceneArguments& arguments) : engine_(engine) {
    for (const char* id : {"ruthless", "inconsistent", "consistent", "quadratic"})
      compiled_.push_back(compile_throughout(engine, arguments, id));
    const State& start = engine.scene().initial;
    const DenseSystem s = compiled_[0].equations->system(start.time, start.y);
    for (std::size_t i = 0; i < s.size; ++i) inertias_.push_back(s.mass[i * (s.size + 1)]);
    ledger_.groups = coordinate_groups(engine.model().layout());
    ledger_.sizes.resize(ledger_.groups.size());
  }
  void enter(const State& state) {
    const Layout& layout = engine_.model().layout();
    std::vector<double> rates(engine_.equations().size());
    Work work = engine_.equations().make_work();
    if (!engine_.equations().derivatives(state.time, state.y, rates, work).ok()) return;
    const TermLedger of(*compiled_[0].model, {compiled_[0].equations.get(), compiled_[1].equations.get(),
                                              compiled_[2].equations.get(), compiled_[3].equations.get()});
    const TermForces forces =
        of.evaluate(state, std::span<const double>(rates).subspan(layout.positions, layout.speeds));
    ledger_.times.push_back(state.time);
    for (std::size_t g = 0; g < ledger_.groups.size(); ++g) {
      for (std::size_t k = 0; k < terms_of_motion; ++k)
        ledger_.sizes[g][k].push_back(size_of(forces[k], ledger_.groups[g], inertias_));
    }
  }
  [[nodiscard]] const Ledger& ledger() const { return ledger_; }

 private:
  const Engine& engine_;
  std::vector<Beyond> compiled_;
  std::vector<double> inertias_;
  Ledger ledger_;
};

std::string cell(double value, double greatest) {
  if (!(greatest > 0) || value < 1e-12 * greatest) return "-";
  return fmt::format("{:.3g}", 100 * value / greatest);
}

std::string table_text(const Ledger& ledger) {
  std::vector<std::string> head = {"<term"};
  for (const CoordinateGroup& g : ledger.groups) {
    head.push_back(g.name + "\nrms %");
    head.push_back(g.name + "\npeak %");
  }
  TextTable table(head);
  for (std::size_t k = 0; k < terms_of_motion; ++k) {
    if (ledger.absent(k)) continue;
    std::vector<std::string> row = {std::string(name(term(k)))};
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

Json ledger_json(const Engine& engine, const RunSummary& summary, const Ledger& ledger) {
  Json j{{"scene", engine.scene().file},   {"formulation", engine.scene().formulation_name},
         {"status", name(summary.status)}, {"message", summary.message},
         {"outputs", ledger.times.size()}, {"unit", "N/sqrt(kg)"},
         {"groups", Json::object()}};
  for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
    Json& group = j["groups"][ledger.groups[g].name];
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      group[std::string(name(term(k)))] = {{"rms", ledger.rms(g, k)}, {"peak", ledger.peak(g, k)}};
  }
  return j;
}

std::string csv_text(const Ledger& ledger) {
  std::vector<Column> columns{{"t", "s"}};
  for (const CoordinateGroup& g : ledger.groups) {
    for (std::size_t k = 0; k < terms_of_motion; ++k)
      columns.push_back({g.name + '.' + std::string(name(term(k))), "N/sqrt(kg)"});
  }
  std::string text = csv_head(columns);
  for (std::size_t i = 0; i < ledger.times.size(); ++i) {
    std::vector<double> row{ledger.times[i]};
    for (const auto& group : ledger.sizes) {
      for (const auto& sizes : group) row.push_back(sizes[i]);
    }
    text += csv_line(row);
  }
  return text;
}

/// Decimal logarithms of the sizes, six decades a panel.
std::string picture(const Engine& engine, const Ledger& ledger) {
  std::vector<std::string> legend;
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < terms_of_motion; ++k) {
    if (ledger.absent(k)) continue;
    shown.push_back(k);
    legend.emplace_back(name(term(k)));
  }
  std::vector<Panel> panels;
  for (std::size_t g = 0; g < ledger.groups.size(); ++g) {
    const double top = std::max(ledger.greatest_peak(g), 1e-300);
    Panel panel{"time [s]", ledger.groups[g].name + " [N/sqrt(kg)]", {1e-6 * top, top}, {}};
    panel.log_y = true;
    for (const std::size_t k : shown) {
      Curve curve;
      for (std::size_t i = 0; i < ledger.times.size(); ++i) {
        curve.x.push_back(ledger.times[i]);
        curve.y.push_back(std::max(ledger.sizes[g][k][i], 1e-300));
      }
      panel.curves.push_back(std::move(curve));
    }
    panels.push_back(std::move(panel));
  }
  const Scene& scene = engine.scene();
  return svg_plot((scene.name.empty() ? scene.file : scene.name) + ": terms along a run of " + scene.formulation_name,
                  legend, panels);
}

}  // namespace

ExitStatus terms(const TermsArguments& arguments) {
  const Engine engine(arguments);
  Bookkeeper book(engine, arguments);
  const RunSummary summary = engine.simulate([&](const State& state) { book.enter(state); });
  const Ledger& ledger = book.ledger();
  const Json j = ledger_json(engine, summary, ledger);
  std::string text = arguments.json ? json_text(j) : "";
  if (!arguments.json) {
    const Scene& scene = engine.scene();
    text = fmt::format("{} ({}, {} outputs, {})\n\n{}", scene.name.empty() ? scene.file : scene.name,
                       scene.formulation_name, ledger.times.size(), outcome_text(summary), table_text(ledger));
  }
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    std::filesystem::create_directories(folder);
    write_file(folder / "terms.csv", csv_text(ledger));
    write_file(folder / "terms.svg", picture(engine, ledger));
    write_file(folder / "terms.json", json_text(j));
    if (!arguments.json) text += "\nterms.csv, terms.svg and terms.json in " + folder.string() + '\n';
  }
  print(text);
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  return exit_status(summary.status);
}

}  // namespace withy::app
