#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "withy/apps/withy/analysis.hpp"
#include "withy/apps/withy/modes_report.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/apps/withy/variation.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

/// Modes of one configuration; `last` is the steady state of the value before, where there is one, and becomes this
/// one's.
ModesAt modes_at(Configuration& c, bool as_is, std::optional<State>& last, BranchTracker& tracker) {
  ModesAt at;
  at.names = c.layout().speed_names;
  State state = c.state();
  if (!as_is) {
    if (last && last->y.size() == state.y.size()) c.begin_at(*last);
    const SteadyState steady = find_steady_state(c.dynamics(), c.state(), c.held());
    at.steady = steady_json(c, steady);
    at.problem = no_steady_state(c, steady);
    if (!steady.converged) return at;
    state = steady.state;
    last = state;
  }
  try {
    const Tangents tangents = c.dynamics().tangents(state.time, state.y, c.dynamics().steady_accelerations(state.time));
    at.modes = tracker.follow(natural_modes(tangents, c.held()), tangents.mass.diagonal().cwiseAbs());
    if (!as_is) {
      at.steady["stays_steady"] = stays_steady(c.dynamics(), tangents, state, c.held());
      at.steady["derivatives"] = derivatives_text(tangents);
    }
  } catch (const std::domain_error& e) {
    at.problem = e.what();
  }
  return at;
}

ModesOf modes_of(const ModesArguments& arguments, const std::string& formulation, const Sweep& sweep) {
  ModesOf run;
  ConfigurationArguments scene = arguments;
  if (!formulation.empty()) scene.options.formulation = formulation;
  std::unique_ptr<Configuration> c;
  std::optional<State> last;
  BranchTracker tracker;
  Progress progress(formulation, static_cast<double>(sweep.values.size()));
  for (std::size_t k = 0; k < sweep.values.size(); ++k) {
    const double value = sweep.values[k];
    const std::string spun = sweep.spun();
    if (!c || (!sweep.none() && spun.empty())) {
      ConfigurationArguments here = scene;
      if (!sweep.none() && spun.empty()) here.options.overrides.push_back(fmt::format("{}={}", sweep.path, value));
      c = std::make_unique<Configuration>(here);
    }
    if (!spun.empty()) c->spin(c->read_spin(fmt::format("{}={}", spun, value), "--sweep"));
    run.points.push_back(modes_at(*c, arguments.as_is, last, tracker));
    run.points.back().value = value;
    progress.at(static_cast<double>(k + 1));
  }
  run.formulation = c->engine().scene().formulation_name;
  return run;
}

}  // namespace

ExitStatus modes(const ModesArguments& arguments) {
  const Sweep sweep = parse_sweep(arguments.sweep, "--sweep");
  std::vector<std::string> formulations = arguments.formulations;
  if (formulations.empty()) formulations.emplace_back();
  std::vector<ModesOf> runs;
  for (const std::string& formulation : formulations) runs.push_back(modes_of(arguments, formulation, sweep));

  Json j;
  j["scene"] = arguments.scene;
  j["sweep"] = sweep.none() ? Json() : Json(sweep.path);
  j["runs"] = Json::array();
  for (const ModesOf& run : runs) j["runs"].push_back(modes_json(run));
  if (!arguments.out.empty()) {
    const std::filesystem::path folder(arguments.out);
    std::filesystem::create_directories(folder);
    write_file(folder / "modes.json", json_text(j));
    write_file(folder / "modes.csv", modes_csv(runs, sweep.none() ? "value" : sweep.path));
    if (!sweep.none())
      write_file(folder / "modes.svg", modes_svg(runs, "Modes of " + arguments.scene, sweep.path, arguments.count));
  }
  if (arguments.json) {
    print(json_text(j));
  } else {
    for (const ModesOf& run : runs) {
      std::string text =
          fmt::format("{}{} in {}\n", &run == &runs.front() ? "" : "\n", arguments.scene, run.formulation);
      const bool found = !run.points.front().modes.empty() || !sweep.none();
      if (found)
        text += '\n' + (sweep.none() ? modes_text(run, arguments.count) : sweep_text(run, sweep.path, arguments.count));
      for (const ModesAt& at : run.points) {
        if (at.steady.is_object() && at.steady.contains("stays_steady") && !at.steady["stays_steady"].get<bool>()) {
          text += "What acts on the free coordinates turns with the hinges: these are modes at this angle alone.\n";
          break;
        }
      }
      print(text);
    }
    if (!arguments.out.empty()) print("\nResults: " + arguments.out + '\n');
  }
  bool failed = false;
  for (const ModesOf& run : runs) {
    for (const ModesAt& at : run.points) {
      if (at.problem.empty()) continue;
      failed = true;
      complain(fmt::format("{}{}: {}", run.formulation,
                           sweep.none() ? "" : fmt::format(", {} = {}", sweep.path, at.value), at.problem));
    }
  }
  return failed ? ExitStatus::stopped : ExitStatus::done;
}

}  // namespace withy::app
