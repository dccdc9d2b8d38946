#include "withy/apps/withy/configuration.hpp"

#include <CLI/CLI.hpp>

namespace withy::app {
namespace {

/// HINGE=RATE.
study::Spin spin_of(const Model& model, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw InputError("--spin: got '" + text + "'; need HINGE=RATE, as axle=6 or axle='60 rev/min'");
  return study::read_spin(model, text.substr(0, equals), text.substr(equals + 1), "--spin");
}

}  // namespace

study::Holding holding_of(const Model& model, const std::vector<std::string>& lock,
                          const std::vector<std::string>& spin) {
  study::Holding holding{lock, {}};
  for (const std::string& text : spin) holding.spun.push_back(spin_of(model, text));
  return holding;
}

study::Configuration configuration_of(const Engine& engine, const ConfigurationArguments& arguments,
                                      study::Sampling sampling) {
  return {engine.prepared(), engine.state(arguments.state), holding_of(engine.model(), arguments.lock, arguments.spin),
          sampling};
}

void add_configuration(CLI::App& command, ConfigurationArguments& a) {
  command.add_option("--at,--state", a.state, "State file (JSON or YAML); default: the scene's initial state")
      ->type_name("FILE");
  command.add_option("--lock", a.lock, "Hinges that are held, at the state's coordinates and rates")
      ->type_name("HINGE,HINGE,...")
      ->delimiter(',');
  command.add_option("--spin", a.spin, "Hinges held at a constant rate, in rad/s, m/s or with a unit")
      ->type_name("HINGE=RATE,...")
      ->delimiter(',');
}

}  // namespace withy::app
