#include <nlohmann/json.hpp>

#include "withy/apps/withy/configuration.hpp"
#include "withy/results/equilibrium_text.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"

namespace withy::app {
namespace {

struct EquilibriumArguments : ConfigurationArguments {
  std::string out;  ///< file for the state; empty: none
};

ExitStatus equilibrium(const EquilibriumArguments& arguments) {
  const Engine engine(arguments);
  keep_inputs(arguments.out, files_of(engine.scene(), arguments.state));
  const study::Configuration c = configuration_of(engine, arguments);
  const study::Holding holding = study::read_holding(engine.model(), arguments.lock, arguments.spin);
  const study::Equilibrium found = study::find_equilibrium(c, holding, engine.registry());
  if (!arguments.out.empty() && found.steady.converged)
    write_file(arguments.out, write_state(engine.model(), found.steady.state) + '\n');
  if (arguments.json) {
    print(json_text(equilibrium_json(c, found)));
  } else if (found.steady.converged) {
    print(equilibrium_text(c, found) + (arguments.out.empty()
                                            ? "\nThe state is in the output of --json, or kept with --out FILE.\n"
                                            : "\nState: " + arguments.out + '\n'));
  }
  if (found.problem.empty()) return ExitStatus::done;
  complain(found.problem);
  return ExitStatus::stopped;
}

void add_equilibrium(Options& o, EquilibriumArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_configuration(o, a);
  o.value("--out", a.out, "FILE", "File for the state, as --at, --state and `initial` read it");
}

}  // namespace

const Command equilibrium_command = {
    "equilibrium", "Find the steady state: at rest, or spinning at constant rates",
    "  withy equilibrium scenes/rotating-blade.yaml --spin axle=6\n"
    "  withy equilibrium scenes/two-link-slew.yaml --lock shoulder,elbow --set gravity.1=-9.81 --out bent.json",
    &taking<EquilibriumArguments, add_equilibrium, equilibrium>};

}  // namespace withy::app
