/// \file
/// What this library brings, each in a file of its own.
#pragma once

#include <withy/core/plugin/body.hpp>
#include <withy/core/plugin/registry.hpp>

namespace example {

withy::Plugin<withy::Body> rod();
withy::Plugin<withy::Body> tapered_beam();
withy::Plugin<withy::StrainKinematics> unturned();

}  // namespace example
