/// \file
/// What `withy advise` tells: in words and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/advice.hpp"
#include "withy/apps/withy/certificate.hpp"

namespace withy::app {

/// A piece of advice with the run that confirmed it.
struct Advice {
  Advisor& advisor;
  const Engine& engine;
  RunSummary confirmed;                ///< the choice, run as `withy run` does
  StepLimit steps;                     ///< of that run
  std::vector<std::string> overrides;  ///< that make the scene what is advised, without what it says already
};

std::string advice_text(const Advice& advice);
nlohmann::ordered_json advice_json(const Advice& advice);
/// Where there is none: why.
std::string no_advice_text(const Advisor& advisor);
/// Everything but the choice.
nlohmann::ordered_json search_json(const Engine& engine, const Advisor& advisor);

}  // namespace withy::app
