/// \file
/// What became of a sweep, as JSON and in words.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "withy/campaign/collect.hpp"
#include "withy/campaign/sweep_run.hpp"

namespace withy::campaign {

/// Cases that ran and that failed, the first of these, and why any was evaluated by itself.
nlohmann::ordered_json outcome_json(const SweepOutcome& outcome, const std::string& store);
std::string outcome_text(const SweepOutcome& outcome, const SweepSettings& settings);

/// How many cases are done, failed and missing; how long the missing ones take, by the threads at work.
nlohmann::ordered_json status_json(const StoreDescription& about, const StoreIndex& index);
std::string status_text(const StoreDescription& about, const StoreIndex& index);

/// The tables that were made, and the share of cases that failed.
nlohmann::ordered_json collected_json(const Collected& collected);
std::string collected_text(const Collected& collected, const std::string& store);

/// What bytes that belong to no record mean.
std::string lost_text(std::uint64_t bytes);

}  // namespace withy::campaign
