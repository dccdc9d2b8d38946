// The formulation and the motion of this project.
#pragma once

#include <withy/core/plugin/registry.hpp>

namespace example {

withy::Plugin<withy::Formulation> slow_linear();
withy::Plugin<withy::Motion> cycloid();

}  // namespace example
