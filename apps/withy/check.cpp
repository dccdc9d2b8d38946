#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/remarks.hpp"
#include "withy/study/run.hpp"

namespace withy::app {
namespace {

struct CheckArguments : SceneArguments {
  bool strict = false;
};

ExitStatus check(const CheckArguments& arguments) {
  const Engine engine(arguments);
  study::check_start(engine.prepared());
  const std::vector<study::Remark> remarks = study::implausible(engine.prepared(), engine.registry());
  const std::vector<std::string>& origins = engine.prepared().values.origins();
  print(arguments.json ? json_text(remarks_json(engine.scene(), remarks, origins))
                       : remarks_text(engine.scene(), remarks, origins));
  return arguments.strict && !remarks.empty() ? ExitStatus::bad_input : ExitStatus::done;
}

void add_check(Options& o, CheckArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  o.flag("--strict", a.strict, "Exit status 2 where anything is implausible");
}

}  // namespace

const Command check_command = {"check", "Validate a scene, and list probable mistakes",
                               "  withy check scenes/two-link-slew.yaml\n"
                               "  withy check scenes/two-link-slew.yaml --strict",
                               &taking<CheckArguments, add_check, check>};

}  // namespace withy::app
