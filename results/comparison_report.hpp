/// \file
/// A comparison of formulations as JSON and in words.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/comparison.hpp"
#include "withy/study/unfit.hpp"

namespace withy {

/// A comparison at one value of what is gone over.
struct ComparisonAt {
  std::string value;  ///< empty where none is gone over
  study::Comparison comparison;
};

/// The content of compare.json: the runs, as run.json has them, each with its greatest distances from the reference.
/// \param over path of what is gone over; may be empty
nlohmann::ordered_json comparison_json(const std::vector<ComparisonAt>& groups, const std::string& reference,
                                       const std::string& over, const std::vector<study::Unfit>& left_out,
                                       Registry& registry);
/// A row a run: outcome, hinges at the end, peaks, cost, greatest errors; below, why runs stopped.
/// \param label of what is gone over; may be empty
std::string comparison_text(const std::vector<ComparisonAt>& groups, const std::string& reference,
                            const std::string& label);
/// A line each: which formulations are not compared, and why.
std::string left_out_text(const std::vector<study::Unfit>& left_out);

}  // namespace withy
