#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/starting_scenes.hpp"
#include "withy/study/input_error.hpp"

namespace withy::app {
namespace {

struct NewArguments {
  std::string kind;
  std::string file;  ///< empty: <kind>.yaml
  bool force = false;
  bool json = false;
};

const StartingScene& scene_of(const std::string& kind) {
  std::vector<std::string> kinds;
  for (const StartingScene& t : starting_scenes()) {
    if (t.kind == kind) return t;
    kinds.emplace_back(t.kind);
  }
  const std::string guess = nearest(kind, kinds);
  throw study::InputError("there is no scene " + in_quotes(kind) + " to start from" +
                          (guess.empty() ? "" : "; did you mean " + in_quotes(guess) + "?") + "; there are " +
                          listed(kinds));
}

ExitStatus write_new(const NewArguments& arguments) {
  const StartingScene& chosen = scene_of(arguments.kind);
  const std::string file =
      output_name("", arguments.file.empty() ? arguments.kind + ".yaml" : arguments.file, arguments.force, {});
  write_file(file, chosen.text);
  print(arguments.json ? json_text({{"file", file}})
                       : file + " is yours to change. Then:\n  withy check " + file + "\n  withy run " + file + '\n');
  return ExitStatus::done;
}

void add_new(Options& o, NewArguments& a) {
  o.value("KIND", a.kind, "{beam,satellite,arm,turbine}", "beam, satellite, arm or turbine").required();
  o.argument("FILE", a.file, "Where to write it; default: KIND.yaml in the current folder");
  o.flag("--force", a.force, "Replace the file where there is one");
  add_json(o, a.json);
}

}  // namespace

const Command new_command = {"new", "Write a commented scene to start from",
                             "  withy new satellite\n"
                             "  withy new arm robot.yaml",
                             &taking<NewArguments, add_new, write_new>};

}  // namespace withy::app
