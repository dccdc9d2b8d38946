/// \file
/// withy-extremes: measures every gate, prints the table, writes it into a document between its two marks.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <set>

#include "campaign.hpp"

namespace withy::extremes {

const std::vector<Extreme>& extremes() {
  static const std::vector<Extreme> all = {
      {"high-modes", "High modes", &high_modes},
      {"tip-mass", "Hinge, clamped modes, heavy tip", &tip_mass},
      {"zeros", "Nothing and almost nothing", &zeros},
      {"spin", "Spin", &spin},
      {"buckling", "Axial load", &buckling},
      {"stability", "Explicit stability", &stability},
      {"rigid-limit", "Stiff and slack", &rigid_limit},
      {"long-run", "Long conservative run", &long_run},
      {"chains", "Long chains", &chains},
      {"rotations", "Rotations", &rotations},
      {"units", "Units by powers of two", &units},
      {"invariance", "Invariance", &invariance},
      {"failures", "Numbers that are none", &failures},
      {"jumps", "Jumps of the right-hand side", &jumps},
      {"denormals", "Denormal numbers", &denormals},
      {"threads", "Threads", &threads},
  };
  return all;
}

}  // namespace withy::extremes

namespace {

using withy::extremes::Row;

constexpr const char* first_mark = "<!-- table of the campaign: begin -->\n";
constexpr const char* last_mark = "<!-- table of the campaign: end -->\n";

std::string table(const std::vector<Row>& rows) {
  const auto cell = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
  };
  std::string out = "| extreme | oracle | gate | measured | verdict |\n|---|---|---|---|---|\n";
  for (const Row& r : rows)
    out += fmt::format("| {} | {} | {} | {} | {} |\n", cell(r.extreme), cell(r.oracle), cell(r.gate), cell(r.measured),
                       r.met ? "met" : "**missed**");
  const auto met = std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.met; });
  return out + fmt::format("\n{} gates, {} met, {} missed.\n", rows.size(), met,
                           static_cast<std::ptrdiff_t>(rows.size()) - met);
}

void write_into(const std::string& file, const std::string& content) {
  const std::string text = withy::extremes::text_of(file);
  const std::size_t first = text.find(first_mark), last = text.find(last_mark);
  if (first == std::string::npos || last == std::string::npos || last < first)
    throw std::runtime_error(file + " has no marks to write between");
  std::ofstream out(file);
  out << text.substr(0, first) << first_mark << '\n' << content << '\n' << text.substr(last);
  if (!out) throw std::runtime_error("cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures withy at its extremes, each against its oracle. Example:\n"
      "  withy-extremes --write docs/extremes.md",
      "withy-extremes");
  bool quick = false, list = false;
  std::vector<std::string> only;
  std::string document;
  app.add_flag("--quick", quick, "what takes seconds alone, with shorter runs and fewer modes");
  app.add_flag("--list", list, "ids of the parts");
  app.add_option("--only", only, "these parts alone, by id");
  app.add_option("--write", document, "a document whose table, between its two marks, is replaced");
  CLI11_PARSE(app, argc, argv);
  const std::set<std::string> chosen(only.begin(), only.end());
  withy::extremes::Campaign campaign(quick);
  std::size_t found = 0;
  try {
    for (const auto& e : withy::extremes::extremes()) {
      if (list) fmt::print("{:<14} {}\n", e.id, e.title);
      if (list || (!chosen.empty() && chosen.count(e.id) == 0)) continue;
      ++found;
      campaign.begin(e.title);
      const auto began = std::chrono::steady_clock::now();
      e.measure(campaign);
      fmt::print("       {:.1f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    }
    if (list) return 0;
    if (found < chosen.size()) throw std::runtime_error("--only names a part that there is not; see --list");
    if (!document.empty()) write_into(document, table(campaign.rows()));
  } catch (const std::exception& e) {
    fmt::print(stderr, "withy-extremes: {}\n", e.what());
    return 2;
  }
  const auto& rows = campaign.rows();
  const auto missed = std::count_if(rows.begin(), rows.end(), [](const Row& r) { return !r.met; });
  fmt::print("{} gates, {} missed\n", rows.size(), missed);
  return rows.empty() || missed > 0 ? 1 : 0;
}
