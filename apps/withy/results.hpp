/// \file
/// The folder a run leaves behind.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "withy/apps/withy/certificate.hpp"

namespace withy::app {

/// Simulates into a folder, made where it is not there: results.csv as the run goes, run.json when it has ended (so a
/// folder without run.json is a run that was killed). `also` sees every output too.
/// \throws std::system_error where something cannot be written.
RunSummary simulate_into(const std::filesystem::path& folder, const Engine& engine,
                         const std::function<void(const State&)>& also = {});

/// A run with what its certificate needs.
struct CertifiedRun {
  RunSummary summary;
  std::optional<Beyond> beyond;
  std::optional<ErrorEstimate> estimate;
  std::optional<EscalatedRun> escalated;  ///< of formulation `auto`
  [[nodiscard]] Evidence evidence() const {
    return {beyond ? &*beyond : nullptr, estimate ? &*estimate : nullptr, escalated ? &*escalated : nullptr};
  }
};
/// The same for `withy run`: what is left out is measured, and its effect estimated after the run.
CertifiedRun run_into(const std::filesystem::path& folder, const Engine& engine, const RunArguments& arguments);

/// Exit status that a run's end stands for.
ExitStatus exit_status(RunStatus status);

}  // namespace withy::app
