#include "withy/apps/withy/results.hpp"

#include <filesystem>

namespace withy::app {

std::unique_ptr<ResultsFolder> take_folder(const OutputArguments& arguments, const std::string& command,
                                           const Provenance& provenance, const std::vector<std::string>& content,
                                           const std::string& read) {
  if (arguments.out.empty()) return nullptr;
  return std::make_unique<ResultsFolder>(arguments.out, command, provenance, content,
                                         arguments.force ? FolderUse::replace : FolderUse::begin,
                                         std::vector<std::filesystem::path>{read});
}

Provenance provenance_of(const Scene& scene, const Plugins& plugins) {
  return withy::provenance_of(scene, plugins.host().versions());
}

std::string default_folder(const SceneArguments& arguments, const std::string& what) {
  std::string name = std::filesystem::path(arguments.scene).stem().string() + '-' + what;
  if (!arguments.options.integrator.empty()) name += '-' + arguments.options.integrator;
  std::vector<std::string> set = arguments.options.overrides;
  set.insert(set.end(), arguments.outputs.begin(), arguments.outputs.end());
  return (std::filesystem::path("results") / (name + folder_suffix(set))).string();
}

ExitStatus ended(const RunSummary& summary) {
  if (summary.status == RunStatus::completed) return ExitStatus::done;
  complain(std::string(name(summary.status)) + ": " + summary.message);
  return summary.status == RunStatus::interrupted ? ExitStatus::interrupted : ExitStatus::stopped;
}

}  // namespace withy::app
