/// \file
/// The folder a run leaves behind.
#pragma once

#include <filesystem>
#include <functional>

#include "withy/apps/withy/engine.hpp"
#include "withy/study/run.hpp"

namespace withy::app {

/// Simulates into a folder, made where it is not there: results.csv as the run goes, run.json when it has ended (so a
/// folder without run.json is a run that was killed). `also` sees every output too.
/// \throws std::system_error where something cannot be written.
RunSummary simulate_into(const std::filesystem::path& folder, const study::Prepared& prepared, Registry& registry,
                         const std::function<void(const State&)>& also = {});

/// The same for `withy run`: its error is estimated after the run, and it may be resumed.
study::CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments);

/// Exit status that a run's end stands for.
ExitStatus exit_status(RunStatus status);

}  // namespace withy::app
