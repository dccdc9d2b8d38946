#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/bindings/fmi/export.hpp"
#include "withy/results/check_columns.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_name.hpp"

namespace withy::app {
namespace {

struct FmuArguments : SceneArguments {
  int version = 3;
  std::vector<std::string> kinds{"me", "cs"};
  std::string out;  ///< empty: the scene's name with .fmu
  bool force = false;
};

ExitStatus make_fmu(const FmuArguments& a) {
  const Engine engine(a);
  check_columns(engine.prepared(), a.outputs);
  fmi::Export what;
  what.version = a.version;
  what.model_exchange = std::find(a.kinds.begin(), a.kinds.end(), "me") != a.kinds.end();
  what.co_simulation = std::find(a.kinds.begin(), a.kinds.end(), "cs") != a.kinds.end();
  what.out = output_name(a.out, renamed(a.scene, ".fmu"), a.force, files_of(engine.scene()));
  const fmi::Exported made = fmi::export_fmu(engine.prepared(), a.options, engine.registry(), what);
  const fmi::Variables& v = made.variables;
  const std::size_t outputs = v.states + v.outputs;
  if (a.json) {
    print(json_text(nlohmann::ordered_json{{"file", what.out.string()},
                                           {"fmi", a.version},
                                           {"kinds", a.kinds},
                                           {"model_identifier", made.description.identifier},
                                           {"token", made.description.token},
                                           {"bytes", made.bytes},
                                           {"states", v.states},
                                           {"inputs", v.inputs},
                                           {"outputs", outputs},
                                           {"parameters", v.parameters},
                                           {"event_indicators", v.indicators}}));
  } else {
    print(fmt::format("written: {} ({:.1f} MB), FMI {}.0, {}\n{} states, {} inputs, {} outputs, {} parameters\n",
                      what.out.string(), 1e-6 * static_cast<double>(made.bytes), a.version, fmt::join(a.kinds, ", "),
                      v.states, v.inputs, outputs, v.parameters));
  }
  return ExitStatus::done;
}

void add_fmu(Options& o, FmuArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  o.argument("--fmi", a.version, "Version of the standard: 2 or 3").among({2, 3}).with_default();
  o.list("--kind", a.kinds, "KIND,...", "Model exchange (me), co-simulation (cs), or both; default: both")
      .among({"me", "cs"});
  o.value("--out", a.out, "FILE", "File; default: the scene's name with .fmu, in the working folder");
  o.flag("--force", a.force, "Replace a file that has the default name");
  o.list("--outputs,--output", a.outputs, "NAME,...", "Outputs to add, as those of withy run");
}

}  // namespace

const Command fmu_command = {"fmu", "Export a scene as an FMU, for other programs to simulate",
                             "  withy fmu scenes/commanded-arm.yaml --out arm.fmu\n"
                             "  withy fmu scenes/commanded-arm.yaml --fmi 2 --kind cs --out arm.fmu",
                             &taking<FmuArguments, add_fmu, make_fmu>};

}  // namespace withy::app
