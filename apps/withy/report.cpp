#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/results_error.hpp"
#include "withy/study/input_error.hpp"

namespace withy::app {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> runs;  ///< folders
  std::string out = report_name;
  int reference = 0;  ///< number of a run; 0: none
  bool force = false;
  bool json = false;
};

/// The page of a folder, or the file itself.
std::vector<std::string> runs_of(const fs::path& given) {
  const fs::path file = fs::is_directory(given) ? given / report_name : given;
  if (fs::exists(file)) return read_report(file);
  if (!fs::exists(given)) throw study::InputError("there is no folder '" + given.string() + "'");
  throw ResultsError(given.string() + " holds no " + report_name +
                     (fs::exists(given / "results.csv") ? ": its run was killed, or made by a build without the page; "
                                                          "run it again, or see its results.csv with withy plot"
                                                        : ": it is no folder of a run or a comparison"));
}

std::string title_of(const std::vector<std::string>& runs) {
  std::vector<std::string> titles;
  std::string all;
  for (const std::string& run : runs) {
    std::string title = nlohmann::ordered_json::parse(run).at("title");
    if (std::find(titles.begin(), titles.end(), title) != titles.end()) continue;
    all += (all.empty() ? "" : ", ") + title;
    titles.push_back(std::move(title));
  }
  return all;
}

ExitStatus report(const ReportArguments& arguments) {
  if (!has_report_page()) {
    complain("this build has no page for reports: it was made without npm. withy plot draws runs as SVG");
    return ExitStatus::environment;
  }
  ReportContent content;
  for (const std::string& folder : arguments.runs)
    for (std::string& run : runs_of(folder)) content.runs.push_back(std::move(run));
  if (arguments.reference > static_cast<int>(content.runs.size()))
    throw study::InputError("--reference: need a number from 1 to " + std::to_string(content.runs.size()) +
                            ", the count of runs, got " + std::to_string(arguments.reference));
  if (fs::exists(arguments.out) && !arguments.force) static_cast<void>(read_report(arguments.out));
  content.title = title_of(content.runs);
  content.reference = arguments.reference - 1;
  write_report(arguments.out, content);
  const std::size_t count = content.runs.size();
  print(arguments.json ? json_text({{"file", arguments.out}, {"runs", count}})
                       : std::to_string(count) + (count == 1 ? " run in " : " runs in ") + arguments.out + '\n');
  return ExitStatus::done;
}

std::function<ExitStatus()> add_report(CLI::App& c) {
  const auto arguments = std::make_shared<ReportArguments>();
  ReportArguments& a = *arguments;
  c.add_option("RUN", a.runs, "Folders of finished runs and comparisons, or their report.html")->required();
  c.add_option("--out", a.out, "File of the page")->type_name("FILE")->capture_default_str();
  c.add_option("--reference", a.reference,
               "Number of the run that differences are taken from, from 1; default: the last")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  c.add_flag("--force", a.force, "Replace a file that is no report");
  add_json(c, a.json);
  return [arguments] { return report(*arguments); };
}

}  // namespace

const Command report_command = {"report", "Show several finished runs on one page",
                                "  withy run scenes/two-link-slew.yaml\n"
                                "  withy run scenes/two-link-slew.yaml --formulation ruthless\n"
                                "  withy report results/two-link-slew-quadratic results/two-link-slew-ruthless "
                                "--reference 1 --out slews.html",
                                &add_report};

}  // namespace withy::app
