#include "withy/results/terms_text.hpp"

#include <fmt/format.h>

#include "withy/results/text_table.hpp"
#include "withy/study/formulation_meaning.hpp"
#include "withy/study/run.hpp"

namespace withy {
namespace {

std::string percent_of(double value, double greatest) {
  if (!(greatest > 0) || value < 1e-12 * greatest) return "-";
  return fmt::format("{:.3g}", 100 * value / greatest);
}

std::string term_sizes_text(const study::TermSizes& ledger) {
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
      row.push_back(percent_of(ledger.rms(g, k), ledger.greatest_rms(g)));
      row.push_back(percent_of(ledger.peak(g, k), ledger.greatest_peak(g)));
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
      row.push_back(percent_of(by.rms(g), ledger.greatest_rms(g)));
      row.push_back(percent_of(by.peak(g), ledger.greatest_peak(g)));
    }
    table.add(std::move(row));
  }
  return "\nLeft out by each formulation of what " + ledger.richest + " keeps, in the same per cent:\n\n" + table.str();
}

}  // namespace

std::string terms_tables(const study::TermSizes& sizes) { return term_sizes_text(sizes) + left_out_text(sizes); }

std::string terms_text(const std::string& title, const Scene& scene, const RunSummary& summary,
                       const study::TermSizes& sizes) {
  return fmt::format("{} ({}, {} outputs, {})\n\n{}", title, study::formulation_title(scene), sizes.times.size(),
                     study::outcome_text(summary), terms_tables(sizes));
}

}  // namespace withy
