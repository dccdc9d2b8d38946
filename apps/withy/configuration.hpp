/// \file
/// What the commands `equilibrium`, `linearize` and `modes` are told to hold, and where.
#pragma once

#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/study/configuration.hpp"

namespace withy::app {

/// Commands that look at small motions about a state.
struct ConfigurationArguments : StateArguments {
  std::vector<std::string>
      lock;  ///< hinges, or single speeds of them, that are held at the state's coordinates and rates
  std::vector<std::string> spin;  ///< `hinge=rate`: held at that rate
};
void add_configuration(Options& options, ConfigurationArguments& arguments);

/// The configuration of a command line. \throws SceneError, InputError, PluginError
study::Configuration configuration_of(const Engine& engine, const ConfigurationArguments& arguments);

}  // namespace withy::app
