/// \file
/// The page that shows runs: one file that needs no network.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace withy {

/// Whether this build holds the page. It is made with npm; a build without it has none.
bool has_report_page();
/// Where the page is in a folder of results.
inline constexpr const char* report_name = "report.html";

/// The last line of an answer that leaves a folder, an empty one before it: "results in out, to look at in its
/// report.html" where this build has pages.
std::string folder_text(const std::string& folder, const std::string& what = "results");

/// JSON as it stands in a page: one line of ASCII.
std::string page_json(const nlohmann::ordered_json& json);

/// Takes a text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// What a page shows.
struct ReportContent {
  std::string title;
  std::vector<std::string> runs;  ///< what RunReport::write wrote of each
  int reference = -1;             ///< index of the run that the others are measured against; −1: none
};
/// Writes the page, whole or not at all. \throws std::system_error; std::logic_error where the build holds no page
void write_report(const std::filesystem::path& file, const ReportContent& content);
/// Writes the page of one run, which need not be in memory as a whole. \param run gives its text to what it is called
/// with
void write_report(const std::filesystem::path& file, const std::string& title,
                  const std::function<void(const TextSink&)>& run);
/// Writes the page of a study in its place. \param kind `trade`, `modes` or `sweep`: what the data are, as
/// web/src/studies reads them. \throws std::system_error; std::logic_error where the build holds no page
void write_study_page(const std::filesystem::path& file, const std::string& kind, const std::string& title,
                      const nlohmann::ordered_json& data);
/// The runs on a page. \throws ResultsError where it is none; std::system_error where it cannot be read
std::vector<std::string> read_report(const std::filesystem::path& file);

}  // namespace withy
