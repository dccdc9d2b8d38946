/// \file
/// withy-extremes: measures every gate, prints the table, writes it into a document between its two marks.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "campaign.hpp"

namespace withy::extremes {

const std::vector<Extreme>& extremes() {
  static const std::vector<Extreme> all = {
      {"high-modes", "High modes", &high_modes},
      {"tip-mass", "Hinge, clamped modes, heavy tip", &tip_mass},
      {"zeros", "Nothing and almost nothing", &zeros},
      {"spin", "Spin", &spin},
      {"spin-up", "Spin-up", &spin_up},
      {"buckling", "Axial load", &buckling},
      {"stability", "Explicit stability", &stability},
      {"rigid-limit", "Stiff and slack", &rigid_limit},
      {"long-run", "Long conservative run", &long_run},
      {"reversal", "Forward and back", &reversal},
      {"chains", "Long chains", &chains},
      {"rotations", "Rotations", &rotations},
      {"units", "Units by powers of two", &units},
      {"units-of-analysis", "Units of linear analyses", &units_of_analysis},
      {"invariance", "Invariance", &invariance},
      {"failures", "Numbers that are none", &failures},
      {"jumps", "Jumps of the right-hand side", &jumps},
      {"stiff-orders", "Order on stiff equations", &stiff_orders},
      {"checkpoints", "Checkpoints", &checkpoints},
      {"work-precision", "Error for tolerance", &work_precision},
      {"detest", "Error for tolerance on problems of others", &detest},
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

constexpr const char* usage =
    "withy-extremes: measures withy at its extremes, each against its oracle\n"
    "  --quick        what takes seconds alone, with shorter runs and fewer modes\n"
    "  --list         ids of the parts\n"
    "  --only ID      this part alone; may be given again\n"
    "  --write FILE   a document whose table, between its two marks, is replaced, the lines of parts not measured "
    "kept\n"
    "Example: withy-extremes --write docs/extremes.md\n"
    "Exit status 1 where a gate is missed.\n";

/// Lines of the table by the title of their part.
using Lines = std::map<std::string, std::vector<std::string>>;

std::string line(const Row& r) {
  const auto cell = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
    return text;
  };
  return fmt::format("| {} | {} | {} | {} | {} |\n", cell(r.extreme), cell(r.oracle), cell(r.gate), cell(r.measured),
                     r.met ? "met" : "**missed**");
}

/// The lines that a document has already: parts that are not measured keep theirs.
Lines lines_in(const std::string& file) {
  Lines lines;
  std::istringstream text(withy::extremes::text_of(file));
  for (std::string row; std::getline(text, row);) {
    for (const auto& e : withy::extremes::extremes()) {
      if (row.starts_with(std::string("| ") + e.title + ": ")) lines[e.title].push_back(row + '\n');
    }
  }
  return lines;
}

std::string table(const Lines& lines) {
  std::string out = "| extreme | oracle | gate | measured | verdict |\n|---|---|---|---|---|\n";
  std::size_t all = 0, missed = 0;
  for (const auto& e : withy::extremes::extremes()) {
    const auto part = lines.find(e.title);
    if (part == lines.end()) continue;
    for (const std::string& row : part->second) {
      out += row;
      ++all;
      if (row.ends_with("| **missed** |\n")) ++missed;
    }
  }
  return out + fmt::format("\n{} gates, {} met, {} missed.\n", all, all - missed, missed);
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
  bool quick = false, list = false;
  std::vector<std::string> only;
  std::string document;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    const bool value = i + 1 < argc;
    if (option == "--quick") {
      quick = true;
    } else if (option == "--list") {
      list = true;
    } else if (option == "--only" && value) {
      only.emplace_back(argv[++i]);
    } else if (option == "--write" && value) {
      document = argv[++i];
    } else {
      fmt::print(option == "--help" ? stdout : stderr, "{}", usage);
      return option == "--help" ? 0 : 2;
    }
  }
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
      const std::size_t before = campaign.rows().size();
      e.measure(campaign);
      // Part by part: a campaign that is stopped has not been for nothing.
      if (!document.empty()) {
        Lines lines = lines_in(document);
        std::vector<std::string>& own = lines[e.title];
        own.clear();
        for (std::size_t i = before; i < campaign.rows().size(); ++i) own.push_back(line(campaign.rows()[i]));
        write_into(document, table(lines));
      }
      fmt::print("       {:.1f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    }
    if (list) return 0;
    if (found < chosen.size()) throw std::runtime_error("--only names a part that there is not; see --list");
  } catch (const std::exception& e) {
    fmt::print(stderr, "withy-extremes: {}\n", e.what());
    return 2;
  }
  const auto& rows = campaign.rows();
  const auto missed = std::count_if(rows.begin(), rows.end(), [](const Row& r) { return !r.met; });
  fmt::print("{} gates, {} missed\n", rows.size(), missed);
  return rows.empty() || missed > 0 ? 1 : 0;
}
