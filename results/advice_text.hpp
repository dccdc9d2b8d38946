/// \file
/// What `withy advise` tells, in words.
#pragma once

#include <string>
#include <vector>

#include "withy/results/advice_json.hpp"

namespace withy {

/// Advice with what was chosen from and what the choice leaves out.
struct AdviceReport {
  AdviceQuestion question;
  const study::Candidates& candidates;
  const study::Advice& advice;
  std::string left_out;
  std::vector<std::string> changes;  ///< `path=value` texts that make the scene what is advised
};
std::string advice_text(const AdviceReport& report);
/// Where there is no choice: why.
std::string no_advice_text(const study::Advice& advice, const study::Accuracy& accuracy);

}  // namespace withy
