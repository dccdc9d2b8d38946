#include "withy/apps/withy/configuration.hpp"

namespace withy::app {

study::Configuration configuration_of(const Engine& engine, const ConfigurationArguments& arguments) {
  study::Configuration c(engine.prepared(), read_state(engine.prepared(), arguments.state),
                         study::read_holding(engine.model(), arguments.lock, arguments.spin));
  if (!c.closing().empty()) complain(c.closing());
  return c;
}

void add_configuration(Options& o, ConfigurationArguments& a) {
  o.value("--at,--state", a.state, "FILE", "State file (JSON or YAML); default: the scene's initial state");
  o.list("--lock", a.lock, "HINGE,HINGE,...", "Hinges that are held, at the state's coordinates and rates");
  o.list("--spin", a.spin, "HINGE=RATE,...", "Hinges held at a constant rate, in rad/s, m/s or with a unit");
}

}  // namespace withy::app
