#include "withy/apps/withy/configuration.hpp"

#include <CLI/CLI.hpp>
#include <optional>

#include "withy/scene/units.hpp"

namespace withy::app {
namespace {

study::Spin read_spin(const Model& model, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw InputError("--spin: got '" + text + "'; need HINGE=RATE, as axle=6 or axle='60 rev/min'");
  const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
  const bool angular = study::rate_is_angular(model, name, "--spin");
  if (const std::optional<double> rate = plain_number(value)) return {name, *rate};
  const QuantityReading quantity = read_quantity(value, angular ? "rad/s" : "m/s");
  if (!quantity.value) throw InputError("--spin: rate of '" + name + "': " + quantity.problem);
  return {name, *quantity.value};
}

}  // namespace

study::Holding holding_of(const Model& model, const std::vector<std::string>& lock,
                          const std::vector<std::string>& spin) {
  study::Holding holding{lock, {}};
  for (const std::string& text : spin) holding.spun.push_back(read_spin(model, text));
  return holding;
}

study::Configuration configuration_of(const Engine& engine, const ConfigurationArguments& arguments) {
  return {engine.prepared(), engine.state(arguments.state), holding_of(engine.model(), arguments.lock, arguments.spin)};
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
