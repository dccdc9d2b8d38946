#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/json_text.hpp"
#include "withy/study/plausibility.hpp"

namespace withy::app {
namespace {

struct CheckArguments : SceneArguments {
  bool strict = false;
};

/// A line: what is odd is said in the form of errors.
std::string line_of(const Scene& scene, const study::Remark& remark) {
  const Place& p = remark.place;
  const std::string at = p.line > 0 ? fmt::format("{}:{}:{}", scene.file, p.line, p.column) : scene.file;
  return fmt::format("{}: {}: {}\n", at, p.path.empty() ? "/" : p.path, remark.text);
}

nlohmann::ordered_json check_json(const Scene& scene, const std::vector<study::Remark>& remarks) {
  nlohmann::ordered_json j{{"scene", scene.file}, {"valid", true}, {"remarks", nlohmann::ordered_json::array()}};
  for (const study::Remark& r : remarks)
    j["remarks"].push_back(
        {{"line", r.place.line}, {"column", r.place.column}, {"path", r.place.path}, {"text", r.text}});
  return j;
}

ExitStatus check(const CheckArguments& arguments) {
  const Engine engine(arguments);
  const Scene& scene = engine.scene();
  const Model& model = engine.model();
  const std::vector<study::Remark> remarks = study::implausible(engine.prepared());
  if (arguments.json) {
    print(json_text(check_json(scene, remarks)));
  } else {
    std::string text;
    for (const study::Remark& remark : remarks) text += line_of(scene, remark);
    const std::size_t n = model.bodies().size();
    text += fmt::format("{} is valid: {} {}, {} {}, formulation {}, integrator {}; {}\n", scene.file, n,
                        n == 1 ? "body" : "bodies", model.layout().speeds,
                        model.layout().speeds == 1 ? "speed" : "speeds", scene.formulation_name, scene.integrator_name,
                        remarks.empty()       ? "nothing is implausible"
                        : remarks.size() == 1 ? "one thing is implausible"
                                              : fmt::format("{} things are implausible", remarks.size()));
    print(text);
  }
  return arguments.strict && !remarks.empty() ? ExitStatus::bad_input : ExitStatus::done;
}

std::function<ExitStatus()> add_check(CLI::App& c) {
  const auto arguments = std::make_shared<CheckArguments>();
  add_scene(c, *arguments);
  add_formulation(c, *arguments);
  c.add_flag("--strict", arguments->strict, "Exit status 2 where anything is implausible");
  return [arguments] { return check(*arguments); };
}

}  // namespace

const Command check_command = {"check", "Validate a scene, and say what in it is hardly meant",
                               "  withy check scenes/two-link-slew.yaml\n"
                               "  withy check scenes/two-link-slew.yaml --strict",
                               &add_check};

}  // namespace withy::app
