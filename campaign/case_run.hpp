/// \file
/// One case: its scene made, run, and what is kept of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "withy/campaign/cases.hpp"
#include "withy/study/control.hpp"

namespace withy::campaign {

struct CaseResult {
  std::uint64_t index = 0;
  std::string status;           ///< of the run; "refused" where the values make no scene or no equations
  std::string message;          ///< why it is not "completed"
  std::vector<Value> values;    ///< as Cases::values
  std::vector<double> numbers;  ///< as kept_columns; none where it is not completed
  double seconds = 0;           ///< CPU time, which differs from run to run
  [[nodiscard]] bool completed() const { return status == "completed"; }
};

/// The same bits for the same case, alone or among others, whatever the thread. A case that is interrupted has that
/// status and is no result.
/// \throws PluginError; what a plugin throws.
CaseResult run_case(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry,
                    const study::Control& control);

}  // namespace withy::campaign
