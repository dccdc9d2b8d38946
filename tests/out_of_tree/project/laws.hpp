// The formulation, the motion and the sensor of this project.
#pragma once

#include <withy/core/plugin/registry.hpp>

namespace example {

withy::Plugin<withy::Formulation> slow_linear();
withy::Plugin<withy::Motion> cycloid();
withy::Plugin<withy::Sensor> speed();

}  // namespace example
