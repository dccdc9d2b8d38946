/// \file
/// One case as JSON and in words, with the command that makes the same run by itself.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/campaign/case_run.hpp"

namespace withy::campaign {

/// `case`, `status`, `message`, `values` that the case sets by their paths, null for what is taken away, `results` by
/// kept_columns, `command`; where the plan keeps any `histories`: `t[s]`, and by history_columns a number a time, null
/// at those that the run has not come to.
nlohmann::ordered_json case_json(const Plan& plan, const CaseResult& result);
/// The same in words. \param result of case_json
std::string case_text(const nlohmann::ordered_json& result);

}  // namespace withy::campaign
