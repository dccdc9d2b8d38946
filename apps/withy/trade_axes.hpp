/// \file
/// What `withy trade` and `withy trade --limit` share.
#pragma once

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/variation.hpp"

namespace withy::app {

/// \throws InputError
study::Axes axes_of(const TradeAxes& asked, Registry& registry);

/// Where along a range of a scene's value each model ceases to hold an accuracy.
/// \throws InputError, SceneError, PluginError
ExitStatus trade_threshold(const TradeArguments& arguments);

}  // namespace withy::app
