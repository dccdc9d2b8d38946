#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/modes_files.hpp"

namespace withy::app {

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

}  // namespace withy::app
