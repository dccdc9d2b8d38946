/// \file
/// Equations of motion of a model by a formulation, whoever wrote it.
#pragma once

#include <memory>

#include "withy/core/plugin/formulation.hpp"

namespace withy {

/// What the formulation makes of a model; never null.
/// \throws std::invalid_argument as Formulation::compile, also where it throws something else or gives nothing;
/// std::bad_alloc; PluginError where a library is refused.
std::unique_ptr<EquationsOfMotion> compile_model(const Formulation& formulation, std::shared_ptr<const Model> model);

}  // namespace withy
