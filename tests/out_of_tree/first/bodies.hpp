// bodies.hpp: what the library brings.
#pragma once

#include <withy/core/plugin/body.hpp>
#include <withy/core/plugin/registry.hpp>

namespace example {

withy::Plugin<withy::Body> rod();  // in rod.cpp

}  // namespace example
