#include "withy/results/report/finished_runs.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/report/gltf.hpp"
#include "withy/results/report/paraview.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/study/input_error.hpp"

namespace withy {

std::vector<std::string> runs_at(const std::filesystem::path& given, const std::filesystem::path& out) {
  const std::filesystem::path file = std::filesystem::is_directory(given) ? given / report_name : given;
  keep_inputs(out, {file});
  if (std::filesystem::exists(file)) return read_report(file);
  if (!std::filesystem::exists(given)) throw study::InputError("there is no folder '" + given.string() + "'");
  if (const std::string writer = writer_of(given); !writer.empty())
    throw ResultsError(given.string() + " holds no " + report_name + " yet: its run is still going on, in " + writer +
                       "; wait for its end, or see its results.csv with withy plot");
  throw ResultsError(given.string() + " holds no " + report_name +
                     (std::filesystem::exists(given / "results.csv")
                          ? ": its run was killed, or made by a build without the page; "
                            "run it again, or see its results.csv with withy plot"
                          : ": it is no folder of a run or a comparison"));
}

std::string title_of_runs(const std::vector<std::string>& runs) {
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

bool write_motion(const std::filesystem::path& out, const std::vector<std::string>& runs) {
  const bool gltf = out.extension() == ".glb";
  if (!gltf && out.extension() != ".pvd") return false;
  std::vector<Animation> animations;
  for (const std::string& run : runs) animations.emplace_back(run);
  if (gltf)
    write_file(out, gltf_binary(animations));
  else
    write_paraview(out, animations);
  return true;
}

}  // namespace withy
