/// \file
/// Trade studies in words.
#pragma once

#include <string>
#include <vector>

#include "withy/results/cheapest_points.hpp"
#include "withy/study/trade.hpp"

namespace withy {

/// The cheapest within some errors, a row a point, the references and their errors, the formulations in a sentence
/// each, why points failed. \param front one a result \param shares errors that the cheapest is named of
std::string trade_text(const std::string& title, const study::TradeStudy& study,
                       const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                       Registry& registry, const std::vector<double>& shares = usual_shares());

}  // namespace withy
