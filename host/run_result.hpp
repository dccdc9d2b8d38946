/// \file
/// A run into memory: what the functions of host::Scene that simulate share.
#pragma once

#include "withy/host/scene.hpp"
#include "withy/study/run.hpp"

namespace withy::host {

struct RunResult {
  Result result;
  RunSummary summary;
};

/// \param settings how; `output` sees every output too \throws SceneError where no run can be
RunResult run_result(const study::Prepared& prepared, Registry& registry, study::RunSettings settings);

}  // namespace withy::host
