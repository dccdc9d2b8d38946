#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/results/inspection.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

ExitStatus inspect(const StateArguments& arguments) {
  const Engine engine(arguments);
  std::vector<LoadedPlugin> loaded;
  for (const PluginRecord& r : engine.plugins().host().plugins())
    if (r.state == PluginRecord::State::loaded) loaded.push_back({r.kind + '/' + r.id, r.file.string()});
  const auto j = inspection_json(engine.prepared(), engine.state(arguments.state), engine.registry(), loaded);
  print(arguments.json ? json_text(j) : inspection_text(engine.scene(), j));
  return ExitStatus::done;
}

void add_inspect(Options& o, StateArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_state(o, a);
}

}  // namespace

const Command inspect_command = {"inspect", "Show the parts of a scene and the simplifications by its compilation",
                                 "  withy inspect scenes/two-link-slew.yaml",
                                 &taking<StateArguments, add_inspect, inspect>};

}  // namespace withy::app
