#include "withy/results/report/report_page.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "withy/results/output_file.hpp"
#include "withy/results/results_error.hpp"

// The page without data, from report_page.S; empty where it was not built.
extern "C" const char withy_report_page[], withy_report_page_end[];

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

std::string_view page() { return {withy_report_page, withy_report_page_end}; }

constexpr std::string_view data_place = "/* data of withy */";
// Each run stands on a line of its own between these.
constexpr std::string_view data_before =
    R"(<script type="application/json" id="withy-data">{"format":"withy-report/1")";
constexpr std::string_view study_before =
    R"(<script type="application/json" id="withy-data">{"format":"withy-study/1",)";
constexpr std::string_view first_run = ",\"runs\":[\n", between = ",\n", data_after = "\n]}</script>";

/// Writes JSON so that it cannot end the element it stands in.
void write_guarded(std::string_view json, OutputFile& page) {
  for (std::size_t at = 0; at < json.size();) {
    const std::size_t stop = std::min(json.find('<', at), json.size());
    page.write(json.substr(at, stop - at));
    if (stop < json.size()) page.write("\\u003c");
    at = stop + 1;
  }
}

void write_head(const std::string& title, int reference, OutputFile& page) {
  page.write(data_before);
  write_guarded(",\"title\":" + page_json(title), page);
  page.write(",\"reference\":" + std::to_string(reference));
  page.write(first_run);
}

/// The page with what `write_data` puts in the place of its data.
void write_page(const std::filesystem::path& file, const std::function<void(OutputFile&)>& write_data) {
  const std::string_view empty = page();
  const std::size_t at = empty.find(data_place);
  if (at == std::string_view::npos) throw std::logic_error("this build holds no page for reports");
  write_file(file, [&](OutputFile& page) {
    page.write(empty.substr(0, at));
    write_data(page);
    page.write(empty.substr(at + data_place.size()));
  });
}

}  // namespace

std::string page_json(const Json& json) { return json.dump(-1, ' ', true, Json::error_handler_t::replace); }

bool has_report_page() { return !page().empty(); }

std::string folder_text(const std::string& folder, const std::string& what) {
  return "\n" + what + " in " + folder + (has_report_page() ? ", to look at in its report.html\n" : "\n");
}

void write_report(const std::filesystem::path& file, const ReportContent& content) {
  write_page(file, [&](OutputFile& page) {
    write_head(content.title, content.reference, page);
    for (std::size_t i = 0; i < content.runs.size(); ++i) {
      if (i > 0) page.write(between);
      write_guarded(content.runs[i], page);
    }
    page.write(data_after);
  });
}

void write_report(const std::filesystem::path& file, const std::string& title,
                  const std::function<void(const TextSink&)>& run) {
  write_page(file, [&](OutputFile& page) {
    write_head(title, -1, page);
    run([&](std::string_view piece) { write_guarded(piece, page); });
    page.write(data_after);
  });
}

void write_study_page(const std::filesystem::path& file, const std::string& kind, const std::string& title,
                      const Json& data) {
  const std::string study = page_json({{"kind", kind}, {"title", title}, {"data", data}});
  write_page(file, [&](OutputFile& page) {
    page.write(study_before);
    write_guarded(std::string_view(study).substr(1, study.size() - 2), page);
    page.write("}</script>");
  });
}

std::vector<std::string> read_report(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::system_error(errno, std::generic_category(), file.string());
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.find(study_before) != std::string::npos)
    throw ResultsError(file.string() + " shows a study, and holds no runs to put on a page; it is one already");
  const std::size_t begin = text.find(data_before), first = text.find(first_run, begin),
                    end = text.find(data_after, first);
  if (begin == std::string::npos || first == std::string::npos || end == std::string::npos)
    throw ResultsError(file.string() + " is no report of this program");
  std::vector<std::string> runs;
  for (std::size_t at = first + first_run.size(); at < end;) {
    const std::size_t stop = std::min(text.find(between, at), end);
    runs.push_back(text.substr(at, stop - at));
    at = stop + between.size();
  }
  return runs;
}

}  // namespace withy
