#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/linear_files.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

struct LinearizeArguments : ConfigurationArguments, OutputArguments {
  study::Ports ports;
};

ExitStatus linearize(const LinearizeArguments& arguments) {
  const Engine engine(arguments);
  const study::Configuration c = configuration_of(engine, arguments, study::Sampling::kept);
  const auto folder = take_folder(arguments, "linearize", provenance_of(engine.scene(), engine.plugins()),
                                  {"linear.json", "linear.mat", "linear.npz"});
  try {
    const study::LinearModel linear = study::linear_model(c, arguments.ports);
    const std::string text = json_text(linear_model_json(c, linear));
    if (folder != nullptr) {
      const std::vector<NamedArray> arrays = linear_model_arrays(linear);
      write_file(*folder / "linear.json", text);
      write_file(*folder / "linear.mat", mat_file(arrays));
      write_file(*folder / "linear.npz", npz_file(arrays));
    }
    print(text);
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
  c.add_option("--inputs,--input", a.ports.inputs,
               "Loads of the type input, hinges whose efforts are inputs, or all: every generalized speed; default: "
               "every input of the scene or, where there is none, every free hinge")
      ->type_name("NAME,...")
      ->delimiter(',');
  c.add_option("--outputs,--output", a.ports.outputs,
               "Outputs of the scene (imu, load1.mz), hinge coordinates (elbow.0), rates (elbow.0.rate), tips "
               "(link2.tip.y); default: the scene's or, where it names none, all others")
      ->type_name("NAME,...")
      ->delimiter(',');
  add_output(c, a, "Folder for linear.json, linear.mat (MATLAB) and linear.npz (NumPy); default: none is kept");
  return [arguments] { return linearize(*arguments); };
}

}  // namespace

const Command linearize_command = {
    "linearize",
    "Matrices A, B, C, D of small motions about a state, for control design, as JSON, for MATLAB and NumPy",
    "  withy linearize scenes/two-link-slew.yaml --at scenes/states/two-link-bent.json\n"
    "  withy linearize scenes/two-link-slew.yaml --inputs shoulder --outputs shoulder,elbow.0.rate,link2.tip\n"
    "  withy linearize scenes/loads-of-the-slew.yaml --input shoulder --output box,root.mz --out results/arm",
    &add_linearize};

}  // namespace withy::app
