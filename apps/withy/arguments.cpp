#include "withy/apps/withy/command.hpp"

namespace withy::app {

Options& add_json(Options& o, bool& json) {
  return o.flag("--json", json, "Give the result as JSON on standard output");
}

void add_common(Options& o, CommonArguments& a) {
  o.repeated("--plugins", a.plugin_directories, "DIR", "Folder with plugins, searched before the program's own");
  add_json(o, a.json);
  o.flag("-v,--verbose", a.verbose, "Log on standard error what is read, loaded and compiled");
}

void add_scene(Options& o, SceneArguments& a) {
  o.argument("SCENE", a.scene, "Scene file (YAML or JSON)").required();
  o.value("--integrator", a.options.integrator, "ID", "Integrator, in place of the scene's");
  o.repeated("--set", a.options.overrides, "PATH=VALUE",
             "Change a value of the scene before it is checked; repeatable");
  add_common(o, a);
}

void add_formulation(Options& o, SceneArguments& a) {
  o.value("--formulation", a.options.formulation, "ID", "Formulation, in place of the scene's");
}

void add_state(Options& o, StateArguments& a) {
  o.value("--state", a.state, "FILE", "State file (JSON or YAML); default: the scene's initial state");
}

void add_output(Options& o, OutputArguments& a, const std::string& meaning) {
  o.value("--out", a.out, "DIR", meaning);
  o.flag("--force", a.force, "Replace another result that the folder holds");
}

}  // namespace withy::app
