#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/inspection.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

ExitStatus inspect(const StateArguments& arguments) {
  const Engine engine(arguments);
  std::vector<LoadedPlugin> loaded;
  for (const PluginRecord& r : engine.plugins().host().plugins())
    if (r.state == PluginRecord::State::loaded) loaded.push_back({r.kind + '/' + r.id, r.file.string()});
  const auto j =
      inspection_json(engine.prepared(), engine.state(arguments.state), engine.formulation_summary(), loaded);
  print(arguments.json ? json_text(j) : inspection_text(engine.scene(), j));
  return ExitStatus::done;
}

std::function<ExitStatus()> add_inspect(CLI::App& c) {
  const auto arguments = std::make_shared<StateArguments>();
  StateArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_state(c, a);
  return [arguments] { return inspect(*arguments); };
}

}  // namespace

const Command inspect_command = {"inspect", "Show what a scene is made of and what its compilation saved",
                                 "  withy inspect scenes/two-link-slew.yaml", &add_inspect};

}  // namespace withy::app
