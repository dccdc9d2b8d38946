/// \file
/// Everything a program needs that has scenes read, varied, run and studied: target withy::withy.
#pragma once

#include "withy/host/equations.hpp"
#include "withy/host/simulation.hpp"
#include "withy/plugins/host/plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/study/advice.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/run.hpp"
#include "withy/study/trade.hpp"
