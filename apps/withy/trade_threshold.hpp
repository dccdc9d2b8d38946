/// \file
/// `withy trade --limit`: where along a range of a scene's value each model ceases to hold an accuracy.
#pragma once

#include "withy/apps/withy/commands.hpp"

namespace withy::app {

/// \throws InputError, SceneError, PluginError
ExitStatus trade_threshold(const TradeArguments& arguments);

}  // namespace withy::app
