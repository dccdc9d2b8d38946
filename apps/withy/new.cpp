#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/scene/names.hpp"
#include "withy/study/input_error.hpp"

// The files of scenes/new, from templates.S.
extern "C" const char withy_new_beam[], withy_new_satellite[], withy_new_arm[], withy_new_turbine[];

namespace withy::app {
namespace {

struct Template {
  const char* kind;
  const char* text;
};
const std::array templates = {Template{"beam", withy_new_beam}, Template{"satellite", withy_new_satellite},
                              Template{"arm", withy_new_arm}, Template{"turbine", withy_new_turbine}};

struct NewArguments {
  std::string kind;
  std::string file;  ///< empty: <kind>.yaml
  bool force = false;
  bool json = false;
};

const Template& template_of(const std::string& kind) {
  std::vector<std::string> kinds;
  for (const Template& t : templates) {
    if (t.kind == kind) return t;
    kinds.emplace_back(t.kind);
  }
  const std::string guess = nearest(kind, kinds);
  throw study::InputError("there is no scene " + in_quotes(kind) + " to start from" +
                          (guess.empty() ? "" : "; did you mean " + in_quotes(guess) + "?") + "; there are " +
                          listed(kinds));
}

ExitStatus write_new(const NewArguments& arguments) {
  const Template& chosen = template_of(arguments.kind);
  const std::string file = arguments.file.empty() ? arguments.kind + ".yaml" : arguments.file;
  if (std::filesystem::exists(file) && !arguments.force)
    throw study::InputError(file + " is there already: name another file, or add --force to replace it");
  write_file(file, chosen.text);
  print(arguments.json ? json_text({{"file", file}})
                       : file + " is yours to change. Then:\n  withy check " + file + "\n  withy run " + file + '\n');
  return ExitStatus::done;
}

std::function<ExitStatus()> add_new(CLI::App& c) {
  const auto arguments = std::make_shared<NewArguments>();
  NewArguments& a = *arguments;
  c.add_option("KIND", a.kind, "beam, satellite, arm or turbine")->required();
  c.add_option("FILE", a.file, "Where to write it; default: KIND.yaml in the current folder");
  c.add_flag("--force", a.force, "Replace the file where there is one");
  add_json(c, a.json);
  return [arguments] { return write_new(*arguments); };
}

}  // namespace

const Command new_command = {"new", "Write a commented scene to start from",
                             "  withy new satellite\n"
                             "  withy new arm robot.yaml",
                             &add_new};

}  // namespace withy::app
