// The parts of this project that are no bodies.
#pragma once

#include <withy/core/plugin/registry.hpp>

namespace example {

withy::Plugin<withy::Hinge> tautochrone();
withy::Plugin<withy::Load> drag();
withy::Plugin<withy::Motion> cycloid();
withy::Plugin<withy::Sensor> speed();
withy::Plugin<withy::Formulation> slow_linear();
withy::Plugin<withy::Integrator> heun3();

}  // namespace example
