/// \file
/// The formulations there are, in their ranks: what studies go through where the user names none.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

struct RankedFormulation {
  std::string id;
  std::string summary;
  Standing standing;
  std::shared_ptr<const Formulation> formulation;  ///< with its options at their defaults
};

/// Every formulation that can be loaded and made without options, lowest rank first, by id within one. What cannot is
/// left out: the registry says why when it is asked for.
std::vector<RankedFormulation> formulations_by_rank(Registry& registry);
/// Ids of those that take part in studies where the user names none.
std::vector<std::string> studied_formulations(Registry& registry);
/// Those that runs of `auto` climb and errors are measured against. \throws std::invalid_argument where there is none
std::vector<RankedFormulation> formulation_rungs(Registry& registry);

}  // namespace withy
