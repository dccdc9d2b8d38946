#include <CLI/CLI.hpp>

#include "withy/apps/withy/command.hpp"

namespace withy::app {

CLI::Option* add_json(CLI::App& command, bool& json) {
  return command.add_flag("--json", json, "Give the result as JSON on standard output");
}

void add_common(CLI::App& command, CommonArguments& a) {
  command.add_option("--plugins", a.plugin_directories, "Folder with plugins, searched before the program's own")
      ->type_name("DIR")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  add_json(command, a.json);
  command.add_flag("-v,--verbose", a.verbose, "Log on standard error what is read, loaded and compiled");
}

void add_scene(CLI::App& command, SceneArguments& a) {
  command.add_option("SCENE", a.scene, "Scene file (YAML or JSON)")->required();
  command.add_option("--integrator", a.options.integrator, "Integrator, in place of the scene's")->type_name("ID");
  command.add_option("--set", a.options.overrides, "Change a value of the scene before it is checked; repeatable")
      ->type_name("PATH=VALUE")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  add_common(command, a);
}

void add_formulation(CLI::App& command, SceneArguments& a) {
  command.add_option("--formulation", a.options.formulation, "Formulation, in place of the scene's")->type_name("ID");
}

void add_formulations(CLI::App& command, std::vector<std::string>& formulations, const std::string& names,
                      const std::string& meaning) {
  command.add_option(names, formulations, meaning)->type_name("ID,ID,...")->delimiter(',');
}

void add_state(CLI::App& command, StateArguments& a) {
  command.add_option("--state", a.state, "State file (JSON or YAML); default: the scene's initial state")
      ->type_name("FILE");
}

void add_output(CLI::App& command, OutputArguments& a, const std::string& meaning) {
  command.add_option("--out", a.out, meaning)->type_name("DIR");
  command.add_flag("--force", a.force, "Replace another result that the folder holds");
}

}  // namespace withy::app
