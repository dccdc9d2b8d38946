#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/finished_runs.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/study/input_error.hpp"

namespace withy::app {
namespace {

struct ReportArguments {
  std::vector<std::string> runs;  ///< folders
  std::string out = report_name;
  int reference = 0;  ///< number of a run; 0: none
  bool force = false;
  bool json = false;
};

void print_counted(std::size_t runs, const ReportArguments& arguments) {
  print(arguments.json ? json_text({{"file", arguments.out}, {"runs", runs}})
                       : std::to_string(runs) + (runs == 1 ? " run in " : " runs in ") + arguments.out + '\n');
}

ExitStatus report(const ReportArguments& arguments) {
  if (!has_report_page()) {
    complain("this build has no page for reports: it was made without npm. withy plot draws runs as SVG");
    return ExitStatus::environment;
  }
  ReportContent content;
  for (const std::string& folder : arguments.runs)
    for (std::string& run : runs_at(folder, arguments.out)) content.runs.push_back(std::move(run));
  if (arguments.reference > static_cast<int>(content.runs.size()))
    throw study::InputError("--reference: need a number from 1 to " + std::to_string(content.runs.size()) +
                            ", the count of runs, got " + std::to_string(arguments.reference));
  if (write_motion(arguments.out, content.runs)) {
    print_counted(content.runs.size(), arguments);
    return ExitStatus::done;
  }
  const std::filesystem::path out = arguments.out;
  if (out.extension() != ".html" && out.extension() != ".htm")
    throw study::InputError("--out: need a name that ends with .html (a page), .glb (glTF) or .pvd (ParaView), got '" +
                            arguments.out + "'");
  if (std::filesystem::is_regular_file(out) && !arguments.force) static_cast<void>(read_report(out));
  content.title = title_of_runs(content.runs);
  content.reference = arguments.reference - 1;
  write_report(arguments.out, content);
  print_counted(content.runs.size(), arguments);
  return ExitStatus::done;
}

void add_report(Options& o, ReportArguments& a) {
  o.argument("RUN", a.runs, "Folders of finished runs and comparisons, or their report.html").required();
  o.value("--out", a.out, "FILE",
          "File of the page; a name that ends with .glb gets the motion as glTF, one with .pvd as a series for "
          "ParaView")
      .with_default();
  o.value("--reference", a.reference, "N",
          "Number of the run that differences are taken from, from 1; default: the last")
      .positive();
  o.flag("--force", a.force, "Replace a file that is no report");
  add_json(o, a.json);
}

}  // namespace

const Command report_command = {"report", "Show several finished runs on one page, or export their motion",
                                "  withy run scenes/two-link-slew.yaml\n"
                                "  withy run scenes/two-link-slew.yaml --formulation ruthless\n"
                                "  withy report results/two-link-slew-quadratic results/two-link-slew-ruthless "
                                "--reference 1 --out slews.html\n"
                                "  withy report results/two-link-slew-quadratic --out slew.glb",
                                &taking<ReportArguments, add_report, report>};

}  // namespace withy::app
