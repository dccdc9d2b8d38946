#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/against_next.hpp"
#include "withy/study/continuous_states.hpp"
#include "withy/study/turning.hpp"

namespace withy::app {
namespace {

struct EquilibriumArguments : ConfigurationArguments {
  std::string out;  ///< file for the state; empty: none
};

using Json = nlohmann::ordered_json;

TextTable hinge_table(const study::Configuration& c, const SteadyState& steady) {
  TextTable table({"<coordinate", "value", "<unit", "rate\n[rad/s, m/s]", "<held", "effort\n[N m, N]"});
  const Model& model = c.prepared().model();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = c.layout().hinges[h];
    const auto columns = coordinate_columns(model.hinges()[h]);
    for (std::size_t i = 0; i < std::max(slot.positions, slot.speeds); ++i) {
      const bool has_speed = i < slot.speeds;
      const bool held = has_speed && c.held()[slot.speed + i];
      table.add({i < slot.positions ? columns[i].name : c.layout().speed_names[slot.speed + i],
                 i < slot.positions ? fmt::format("{:.6g}", steady.state.y[slot.position + i]) : "-",
                 i < slot.positions ? columns[i].unit : "",
                 has_speed ? fmt::format("{:.6g}", steady.state.y[c.layout().positions + slot.speed + i]) : "-",
                 held ? "yes" : "no",
                 held ? fmt::format("{:.6g}", steady.efforts[static_cast<Eigen::Index>(slot.speed + i)]) : "-"});
    }
  }
  return table;
}

ExitStatus equilibrium(const EquilibriumArguments& arguments) {
  const Engine engine(arguments);
  const study::Configuration c = configuration_of(engine, arguments);
  study::refuse_continuous_states(c.prepared(), "'withy equilibrium'");
  const SteadyState steady = find_steady_state(c.dynamics(), c.state(), c.held());
  const Tangents tangents =
      c.dynamics().tangents(steady.state.time, steady.state.y, c.dynamics().steady_accelerations(steady.state.time));
  const bool steady_for_good = stays_steady(c.dynamics(), tangents, steady.state, c.held());
  const std::string problem = study::no_steady_state(c, steady);
  const Scene& scene = c.prepared().scene;
  const std::string state = write_state(c.prepared().model(), steady.state);
  if (!arguments.out.empty() && steady.converged) write_file(arguments.out, state + '\n');

  Json deflections = Json::object();
  for (const Tip& tip : tips(c.prepared().model())) {
    if (tip.flexible) deflections[tip.body + ".tip"] = deflection(*c.prepared().equations, steady.state.y, tip);
  }
  const study::Holding holding = holding_of(c.prepared().model(), arguments.lock, arguments.spin);
  const auto against = study::deflections_against_next(c, steady, holding, engine.registry());
  const std::vector<std::string> passing =
      steady_for_good ? std::vector<std::string>() : study::moving_freely(c, steady.state);
  const std::string changing =
      steady_for_good ? ""
      : !passing.empty()
          ? study::passing_text(passing)
          : "The hinges turn and what acts on the free coordinates turns with them (gravity in the plane of "
            "rotation, as a rule): this state is steady at this angle alone.";
  if (arguments.json) {
    Json j;
    j["scene"] = scene.file;
    j["formulation"] = scene.formulation_name;
    j.update(steady_json(engine.model(), steady, c.held()));
    j["tip_deflections"] = deflections;
    j["stays_steady"] = steady_for_good;
    j["against_next"] = against_json(against);
    j["derivatives"] = study::derivatives_text(tangents);
    j["message"] = problem.empty() ? changing : problem;
    print(json_text(j));
  } else if (steady.converged) {
    std::string text = fmt::format("{} in {}: {} after {} steps of Newton's method\n\n{}", scene.file,
                                   scene.formulation_name, passing.empty() ? "steady" : "balanced at this instant",
                                   steady.iterations, hinge_table(c, steady).str());
    if (!deflections.empty()) {
      TextTable table({"<tip", "deflection x\n[mm]", "y\n[mm]", "z\n[mm]"});
      for (const auto& [name, d] : deflections.items()) {
        std::vector<std::string> cells = {name};
        for (const double x : d.get<std::vector<double>>()) cells.push_back(fmt::format("{:.6g}", 1e3 * x));
        table.add(std::move(cells));
      }
      text += '\n' + table.str();
    }
    if (const std::string words = study::against_next_text(against, "deflections"); !words.empty())
      text += '\n' + words + '\n';
    if (!changing.empty()) text += '\n' + changing + '\n';
    text += arguments.out.empty() ? "\nThe state is in the output of --json, or kept with --out FILE.\n"
                                  : "\nState: " + arguments.out + '\n';
    print(text);
  }
  if (problem.empty()) return ExitStatus::done;
  complain(problem);
  return ExitStatus::stopped;
}

std::function<ExitStatus()> add_equilibrium(CLI::App& c) {
  const auto arguments = std::make_shared<EquilibriumArguments>();
  EquilibriumArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_configuration(c, a);
  c.add_option("--out", a.out, "File for the state, as --at, --state and `initial` read it")->type_name("FILE");
  return [arguments] { return equilibrium(*arguments); };
}

}  // namespace

const Command equilibrium_command = {
    "equilibrium", "Find the state that stays as it is: at rest, or spinning steadily",
    "  withy equilibrium scenes/rotating-blade.yaml --spin axle=6\n"
    "  withy equilibrium scenes/two-link-slew.yaml --lock shoulder,elbow --set gravity.1=-9.81 --out bent.json",
    &add_equilibrium};

}  // namespace withy::app
