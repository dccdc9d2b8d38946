#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/modes_files.hpp"

namespace withy::app {
namespace {

struct LinearizeArguments : ConfigurationArguments {
  std::vector<std::string> inputs;   ///< hinges or speeds; `all` is every speed; empty: every hinge
  std::vector<std::string> outputs;  ///< names or their beginnings; empty: every output
};

ExitStatus linearize(const LinearizeArguments& arguments) {
  const Engine engine(arguments);
  const study::Configuration c = configuration_of(engine, arguments);
  try {
    print(json_text(linear_model_json(c, study::linear_model(c, {arguments.inputs, arguments.outputs}))));
  } catch (const std::domain_error& e) {
    complain(e.what());
    return ExitStatus::stopped;
  }
  return ExitStatus::done;
}

std::function<ExitStatus()> add_linearize(CLI::App& c) {
  const auto arguments = std::make_shared<LinearizeArguments>();
  LinearizeArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_configuration(c, a);
  c.add_option("--inputs", a.inputs,
               "Hinges whose efforts are inputs, or all: every generalized speed; default: every free hinge")
      ->type_name("HINGE,...")
      ->delimiter(',');
  c.add_option("--outputs", a.outputs,
               "Hinge coordinates (elbow.0), rates (elbow.0.rate), tips (link2.tip.y); default: all")
      ->type_name("NAME,...")
      ->delimiter(',');
  return [arguments] { return linearize(*arguments); };
}

}  // namespace

const Command linearize_command = {
    "linearize", "Matrices A, B, C, D of small motions about a state, for control design, as JSON",
    "  withy linearize scenes/two-link-slew.yaml --at scenes/states/two-link-bent.json\n"
    "  withy linearize scenes/two-link-slew.yaml --inputs shoulder --outputs shoulder,elbow.0.rate,link2.tip",
    &add_linearize};

}  // namespace withy::app
