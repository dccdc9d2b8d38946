/// \file
/// What `withy advise` tried, as a picture.
#pragma once

#include "withy/results/svg_plot.hpp"
#include "withy/study/advice.hpp"

namespace withy {

/// Every model that was tried but those that were cut for their cost: its error, in parts of the accuracy asked, over what it costs; below 1 it holds.
/// A pen a formulation, circles around the choice, a line at 1.
Picture advice_picture(const study::Advice& advice);

}  // namespace withy
