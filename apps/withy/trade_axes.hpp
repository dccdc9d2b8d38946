/// \file
/// What `withy trade` and `withy trade --limit` share.
#pragma once

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/variation_text.hpp"

namespace withy::app {

struct TradeArguments : SceneArguments, OutputArguments {
  study::Axes axes;               ///< what is empty is as study::trade_axes has it
  std::vector<std::string> over;  ///< `path=value,value,…`; where a limit is sought, one of them `path=from:to[:count]`
  std::vector<std::string> accuracy;  ///< errors that the cheapest model is named of; empty: the usual ones
  std::string limit;             ///< relative error whose passing is sought along a range in `over`; empty: a trade
  std::string measure = "runs";  ///< what that error is of: runs, frequencies
  std::size_t count = 2;         ///< modes whose frequencies are compared
  std::vector<std::string> lock, spin;  ///< for frequencies: as in ConfigurationArguments
  std::size_t jobs = 0;                 ///< threads; 0: one a core
};

/// The points of the axes at each of the values gone over. \throws InputError
std::vector<study::Point> points_of(study::Axes axes, const std::vector<std::string>& over, const Engine& engine);

/// Where along a range of a scene's value each model ceases to hold an accuracy.
/// \throws InputError, SceneError, PluginError
ExitStatus trade_threshold(const TradeArguments& arguments);

}  // namespace withy::app
