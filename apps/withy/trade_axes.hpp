/// \file
/// What `withy trade` and `withy trade --limit` share.
#pragma once

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/variation.hpp"

namespace withy::app {

/// Values of each axis; their product is the study.
struct TradeAxes {
  std::vector<std::string> formulations;     ///< empty: those that take part in studies
  std::vector<std::string> families = {""};  ///< of bending; empty text: the scene's
  std::vector<int> modes = {1, 2, 3};        ///< of each family that a beam has
  std::vector<std::string> integrators = {"dopri5", "imex"};
  std::vector<double> tolerances = {1e-4, 1e-6};  ///< relative; absolute ones are 1e-2 of them
  std::vector<std::string> over;  ///< `path=value,value,…`; where a limit is sought, one of them `path=from:to[:count]`
};

struct TradeArguments : SceneArguments, OutputArguments {
  TradeAxes axes;
  std::string limit;             ///< relative error whose passing is sought along a range in `over`; empty: a trade
  std::string measure = "runs";  ///< what that error is of: runs, frequencies
  std::size_t count = 2;         ///< modes whose frequencies are compared
  std::vector<std::string> lock, spin;  ///< for frequencies: as in ConfigurationArguments
  std::vector<std::string> outputs;     ///< that errors are measured on; empty: all of the usual ones
  std::size_t jobs = 0;                 ///< threads; 0: one a core
};

/// \throws InputError
study::Axes axes_of(const TradeAxes& asked, Registry& registry);

/// Where along a range of a scene's value each model ceases to hold an accuracy.
/// \throws InputError, SceneError, PluginError
ExitStatus trade_threshold(const TradeArguments& arguments);

}  // namespace withy::app
