/// \file
/// Equations of a model whose events lock and unlock hinges: one set of equations for each configuration, chosen by the
/// state itself.
#pragma once

#include <functional>
#include <memory>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy::equations {

/// Whether a model's events lock hinges.
bool has_configurations(const Model& model);

/// The equations of a model with configurations, each made by `compile` from the model with its hinges locked. They
/// share one layout; the configuration is a discrete state, so that threads, checkpoints and studies need not know.
/// \throws std::invalid_argument where constraints close loops of the model.
std::unique_ptr<EquationsOfMotion> make_configured(
    const Model& model, const std::function<std::unique_ptr<EquationsOfMotion>(std::shared_ptr<const Model>)>& compile);

}  // namespace withy::equations
