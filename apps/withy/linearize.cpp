#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/linear_files.hpp"
#include "withy/study/at_limits.hpp"

namespace withy::app {
namespace {

struct LinearizeArguments : ConfigurationArguments, OutputArguments {
  std::vector<std::string> inputs;
};

ExitStatus linearize(const LinearizeArguments& arguments) {
  const Engine engine(arguments);
  const study::Configuration c = configuration_of(engine, arguments);
  const auto folder = take_folder(arguments, "linearize", provenance_of(engine.scene(), engine.plugins()),
                                  linear_model_content(), arguments.state);
  try {
    const study::LinearModel linear = study::linear_model(c, {arguments.inputs, arguments.outputs});
    const nlohmann::ordered_json json = linear_model_json(c, linear);
    if (folder != nullptr) write_linear_model(folder->path(), json, linear);
    print(json_text(json));
    // A state that does not stay is one instant of a motion anyhow.
    if (const std::string note = study::note_of_frozen(linear); linear.equilibrium && !note.empty()) complain(note);
    if (const std::string note = study::note_of_changing(linear, c.state().time); !note.empty()) complain(note);
    if (const std::string note = study::at_limits_text(linear.limited); !note.empty()) complain(note);
  } catch (const std::domain_error& e) {
    complain(e.what());
    return ExitStatus::stopped;
  }
  return ExitStatus::done;
}

void add_linearize(Options& o, LinearizeArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_configuration(o, a);
  o.list("--inputs,--input", a.inputs, "NAME,...",
         "Loads of the type input, hinges whose efforts are inputs, or all: every generalized speed; default: "
         "every input of the scene or, where there is none, every free hinge");
  o.list("--outputs,--output", a.outputs, "NAME,...",
         "Outputs (imu, load1.mz, boom.tip.acceleration), hinge coordinates (elbow.0), rates (elbow.0.rate), tips "
         "(link2.tip.y); default: the scene's or, where it names none, all others");
  add_output(o, a, "Folder for linear.json, linear.mat (MATLAB) and linear.npz (NumPy); default: none is kept");
}

}  // namespace

const Command linearize_command = {
    "linearize",
    "Matrices A, B, C, D of small motions about a state, for control design, as JSON, for MATLAB and NumPy",
    "  withy linearize scenes/two-link-slew.yaml --at scenes/states/two-link-bent.json\n"
    "  withy linearize scenes/two-link-slew.yaml --inputs shoulder --outputs shoulder,elbow.0.rate,link2.tip\n"
    "  withy linearize scenes/loads-of-the-slew.yaml --input shoulder --output box,root.mz --out results/arm",
    &taking<LinearizeArguments, add_linearize, linearize>};

}  // namespace withy::app
