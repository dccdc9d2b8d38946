#include <nlohmann/json.hpp>
#include <stdexcept>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/response_files.hpp"

namespace withy::app {
namespace {

struct ResponseArguments : ConfigurationArguments, OutputArguments {
  study::ResponseQuestion question;
  bool csv = false;
};

ExitStatus respond(const ResponseArguments& given) {
  ResponseArguments arguments = given;
  arguments.outputs = {arguments.question.output};
  const Engine engine(arguments);
  const study::Configuration c = configuration_of(engine, arguments);
  const auto folder = take_folder(arguments, "response", provenance_of(engine.scene(), engine.plugins()),
                                  response_content(), arguments.state);
  try {
    const study::Response r = study::response(c, arguments.question);
    if (folder != nullptr) write_response(folder->path(), c, r);
    if (arguments.json)
      print(json_text(response_json(c, r)));
    else if (arguments.csv)
      print(response_csv(r));
    else
      print(response_text(c, r) + (folder != nullptr ? folder_text(arguments.out) : ""));
  } catch (const std::domain_error& e) {
    complain(e.what());
    return ExitStatus::stopped;
  }
  return ExitStatus::done;
}

void add_response(Options& o, ResponseArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_configuration(o, a);
  o.value("--input,--inputs", a.question.input, "NAME",
          "A load of the type input, or a hinge; or a load that feeds back, or LOAD.HINGE, whose loop is opened")
      .required();
  o.value("--output,--outputs", a.question.output, "NAME",
          "One component of an output (imu.x, boom.tip.velocity.vy), a coordinate (elbow.0), or tip (link2.tip.y)");
  o.value("--from", a.question.from, "HZ", "Lowest frequency; default: a decade below all poles").positive();
  o.value("--to", a.question.to, "HZ",
          "Highest frequency; default: a decade above all poles, or half the samples' rate")
      .positive();
  o.value("--points", a.question.per_decade, "N", "Frequencies a decade; more where a resonance is sharp")
      .between(5, 100000)
      .with_default();
  o.value("--reduce", a.question.reduce, "N", "Balanced truncation to so many states, with the bound of its error")
      .between(0, 100000);
  o.flag("--csv", a.csv, "Print the values as a table");
  add_output(o, a,
             "Folder for report.html, response.json, response.csv, bode.svg and nichols.svg; default: none is kept");
}

}  // namespace

const Command response_command = {
    "response", "Transfer function from an input to an output, resonances, and the margins of a loop",
    "  withy response scenes/loads-of-the-slew.yaml --input shoulder --output box.y --to 100\n"
    "  withy response scenes/pd-arm.yaml --input control.shoulder --out results/loop",
    &taking<ResponseArguments, add_response, respond>};

}  // namespace withy::app
