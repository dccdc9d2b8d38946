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
/// What was asked: the accuracy, and what it is of.
std::string question_text(const AdviceQuestion& question);
/// Where there is no choice: why, and what was measured.
std::string no_advice_text(const study::Advice& advice, const AdviceQuestion& question);

}  // namespace withy
