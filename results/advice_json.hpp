/// \file
/// Advice as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/study/advice.hpp"

namespace withy {

/// What was asked.
struct AdviceQuestion {
  const study::Prepared& prepared;
  const study::Outputs& outputs;
  const study::Accuracy& accuracy;
};
/// What was measured, "advice" null. \param reason why there is none; empty: there is
nlohmann::ordered_json search_json(const AdviceQuestion& question, const study::Advice& advice,
                                   const std::string& reason);
/// All of it, where there is a choice.
/// \param left_out what the model chosen does not know
/// \param changes `path=value` texts that make the scene what is advised, and as lines of the scene
nlohmann::ordered_json advice_json(const AdviceQuestion& question, const study::Advice& advice,
                                   const std::string& left_out, const std::vector<std::string>& changes,
                                   const std::string& scene_lines);

}  // namespace withy
