/// \file
/// The answer of a trade: the cheapest models within some errors.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/study/trade.hpp"

namespace withy {

/// The relative errors that a trade answers for where nobody asks for others.
inline std::vector<double> usual_shares() { return {0.1, 0.01, 0.001}; }

/// The cheapest of the points at one set of values gone over, within an error.
struct CheapestPoint {
  std::string over;                       ///< trade_over_text
  double within = 0;                      ///< share of each output's own range
  const study::TradeResult* result = {};  ///< null: none of the points is within it
};
std::vector<CheapestPoint> cheapest_points(const std::vector<study::TradeResult>& results,
                                           const std::vector<double>& shares);
std::string cheapest_text(const std::vector<study::TradeResult>& results, const std::vector<double>& shares);
/// `over`, `within`, and `point`, the place among the results; null where none is within it.
nlohmann::ordered_json cheapest_json(const std::vector<study::TradeResult>& results, const std::vector<double>& shares);

}  // namespace withy
