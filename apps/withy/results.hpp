/// \file
/// The folder a command leaves behind, and its exit status.
#pragma once

#include <memory>

#include "withy/apps/withy/engine.hpp"
#include "withy/results/results_folder.hpp"

namespace withy::app {

/// Takes the folder of the command line; null where none is asked for.
/// \param content of the folder, as ResultsFolder has it \param read a file that the command reads beside those of its
/// scene; may be empty
/// \throws ResultsError, FolderBusy, InputError, as ResultsFolder; std::system_error
std::unique_ptr<ResultsFolder> take_folder(const OutputArguments& arguments, const std::string& command,
                                           const Provenance& provenance, const std::vector<std::string>& content,
                                           const std::string& read = {});

/// What results of the scene come from.
Provenance provenance_of(const Scene& scene, const Plugins& plugins);

/// `results/<scene>-<what>`, with what `--integrator` and `--set` say behind it.
std::string default_folder(const SceneArguments& arguments, const std::string& what);

/// Says why a run did not come to its end. \returns the exit status that its end stands for
ExitStatus ended(const RunSummary& summary);

}  // namespace withy::app
