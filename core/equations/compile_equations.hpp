/// \file
/// From a model to equations of motion: what every formulation plugin calls.
#pragma once

#include <memory>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

/// Equations of motion of a model whose bodies have `terms`, but for those with terms of their own. Chooses the space,
/// merges rigid neighbours, keeps the constants that the terms need and lays out the work memory.
/// \throws std::invalid_argument where bodies mix strict and untruncated terms, which no order of the equations unites.
[[gnu::visibility("default")]] std::unique_ptr<EquationsOfMotion> compile_equations(std::shared_ptr<const Model> model,
                                                                                    Terms terms);

}  // namespace withy
