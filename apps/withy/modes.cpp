#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/variation.hpp"
#include "withy/results/effective_mass_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/modes_text.hpp"
#include "withy/results/mounted_damping_files.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/modes_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/against_next.hpp"

namespace withy::app {
namespace {

struct ModesArguments : ConfigurationArguments, OutputArguments {
  std::vector<std::string> formulations;  ///< empty: the scene's
  std::string sweep;              ///< `path=a:b:n`, a path of the scene or `spin.hinge`; empty: one configuration
  std::size_t count = 6;          ///< modes that are shown
  bool as_is = false;             ///< about the state as it is given, steady or not
  bool poles = false;             ///< all eigenvalues are listed
  bool masses = false;            ///< effective masses are found
  std::string write;              ///< the scene with the damping found; empty: nowhere
  std::vector<std::string> damp;  ///< ratios that the lowest vibrations shall have
  bool floquet = false;           ///< characteristic exponents over a turn
  std::optional<std::vector<std::string>> blades;  ///< equal blades by names, or `auto`; none: not asked
  double period = 0;                               ///< [s]; 0: found from the rates
};

using Json = nlohmann::ordered_json;

study::TurningWish wish_of(const ModesArguments& arguments) {
  study::TurningWish wish;
  wish.floquet = arguments.floquet;
  wish.blades = arguments.blades.has_value();
  if (wish.blades) {
    for (const std::string& name : *arguments.blades) {
      if (name != "auto") wish.names.push_back(name);
    }
  }
  wish.period = arguments.period;
  return wish;
}

/// One run a formulation, and at one configuration how far each is from the next.
std::vector<study::ModesOf> runs_of(const Engine& engine, const ModesArguments& arguments, const study::Sweep& sweep,
                                    std::vector<std::optional<study::AgainstNext>>& against) {
  const study::Holding holding = holding_of(engine.model(), arguments.lock, arguments.spin);
  const auto start = [&](const study::Prepared& prepared) { return read_state(prepared, arguments.state); };
  std::vector<std::string> formulations = arguments.formulations;
  if (formulations.empty()) formulations.push_back(engine.scene().formulation_name);
  std::vector<study::ModesOf> runs;
  for (const std::string& formulation : formulations) {
    SceneValues values = engine.prepared().values;
    values.choose_formulation(formulation, "--formulations " + formulation);
    runs.push_back(study::sweep_modes(values, engine.registry(), start, holding, sweep, arguments.as_is,
                                      wish_of(arguments), study_control(formulation)));
    against.emplace_back();
    if (sweep.none() && !interrupted())
      against.back() = study::frequencies_against_next(runs.back(), values, engine.registry(), start, holding,
                                                       arguments.as_is, arguments.count, study_control(formulation));
  }
  return runs;
}

std::string run_text(const study::ModesOf& run, const ModesArguments& arguments, const study::Sweep& sweep,
                     const std::optional<study::AgainstNext>& against) {
  std::string text = fmt::format("{} in {}\n", arguments.scene, run.formulation);
  if (!run.points.front().modes.empty() || !sweep.none())
    text += '\n' + (sweep.none() ? modes_text(run, arguments.count) : sweep_text(run, sweep.path, arguments.count));
  if (const std::string words =
          study::against_next_text(against, fmt::format("the {} lowest frequencies", against ? against->compared : 0));
      !words.empty())
    text += '\n' + words + '\n';
  // Of a sweep the first value at which the equations are periodic speaks for all.
  const auto frozen = std::find_if(run.points.begin(), run.points.end(), [](const auto& at) { return at.frozen(); });
  const study::ModesAt& spoken_of = frozen != run.points.end() ? *frozen : run.points.back();
  if (spoken_of.turn) {
    if (const std::string words = study::turn_text(*spoken_of.turn); !words.empty()) text += '\n' + words + '\n';
  }
  if (arguments.poles && !run.points.front().modes.empty()) text += '\n' + poles_text(run.points.front());
  for (const study::ModesAt& at : run.points) {
    if (at.turn)
      text += turning_text(*at.turn, sweep.none() ? "" : fmt::format("{} = {}", sweep.path, sweep.text(at.value)));
  }
  return text;
}

void write_files(const std::vector<study::ModesOf>& runs, const Json& j, const ModesArguments& arguments,
                 const study::Sweep& sweep) {
  const std::filesystem::path folder(arguments.out);
  write_file(folder / "modes.json", json_text(j));
  write_file(folder / "modes.csv", modes_csv(runs, sweep.none() ? "value" : sweep.path));
  if (!sweep.none())
    write_file(folder / "modes.svg",
               modes_picture(runs, "Modes of " + arguments.scene, swept_label(sweep), arguments.count));
  if (has_report_page())
    write_study_page(folder / report_name, "modes", "Modes of " + arguments.scene,
                     modes_page(runs, sweep, arguments.count));
}

/// Says on standard error where there are no modes, and why. False where there are everywhere.
bool complain_of(const std::vector<study::ModesOf>& runs, const study::Sweep& sweep) {
  bool failed = false;
  for (const study::ModesOf& run : runs) {
    for (const study::ModesAt& at : run.points) {
      if (at.turn && !at.turn->problem.empty()) {
        failed = true;
        complain("a whole turn: " + at.turn->problem);
      }
      if (at.turn && !at.turn->blade_problem.empty()) {
        failed = true;
        complain("--blades: " + at.turn->blade_problem);
      }
      if (at.problem.empty()) continue;
      failed = true;
      complain(fmt::format("{}{}: {}", run.formulation,
                           sweep.none() ? "" : fmt::format(", {} = {}", sweep.path, at.value), at.problem));
    }
  }
  return failed;
}

/// The steady state that the modes are about.
study::Configuration steady_configuration(const Engine& engine, const ModesArguments& arguments,
                                          const study::ModesAt& at) {
  study::Configuration c = configuration_of(engine, arguments);
  if (at.steady) c.set_state(at.steady->steady.state);
  return c;
}

std::vector<double> damping_ratios(const std::vector<std::string>& texts) {
  std::vector<double> ratios;
  for (const std::string& text : texts) {
    std::optional<double> ratio = plain_number(text);
    if (!ratio) ratio = read_quantity(text, "1").value;
    if (!ratio || !(*ratio > 0) || !(*ratio < 1))
      throw InputError("--damp takes ratios of critical damping between 0 and 1, as 0.01 or \"1 %\", and not '" + text +
                       "'");
    ratios.push_back(*ratio);
  }
  return ratios;
}

/// What is asked for one configuration beside its modes.
void require_one_configuration(const ModesArguments& arguments, const study::Sweep& sweep) {
  if (sweep.none() && arguments.formulations.empty()) return;
  for (const auto& [asked, option] :
       {std::pair{arguments.masses, "--effective-mass"}, {!arguments.damp.empty(), "--damp"}}) {
    if (asked)
      throw InputError(std::string(option) +
                       " is of one configuration, in the scene's formulation: leave out --sweep and --formulations, or "
                       "--set formulation=ID");
  }
}

ExitStatus modes(const ModesArguments& arguments) {
  const study::Sweep sweep = parse_sweep(arguments.sweep, "--sweep");
  require_one_configuration(arguments, sweep);
  const std::vector<double> ratios = damping_ratios(arguments.damp);
  if (!arguments.write.empty() && ratios.empty()) throw InputError("--write writes what --damp finds: give that too");
  if (!arguments.write.empty() && !arguments.options.overrides.empty())
    throw InputError("--write takes the scene as its file has it: put what --set changes into the file first");
  const Engine engine(arguments);
  const auto folder = take_folder(arguments, "modes", provenance_of(engine.scene(), engine.plugins()),
                                  {"modes.json", "modes.csv", "modes.svg", report_name});
  std::vector<std::optional<study::AgainstNext>> against;
  const std::vector<study::ModesOf> runs = runs_of(engine, arguments, sweep, against);
  if (interrupted()) return ExitStatus::interrupted;
  const study::ModesAt& first = runs.front().points.front();
  std::optional<study::EffectiveMasses> masses;
  std::optional<study::MountedDamping> damping;
  if (first.problem.empty() && arguments.masses)
    masses = study::effective_masses(steady_configuration(engine, arguments, first));
  if (first.problem.empty() && !ratios.empty())
    damping = study::mounted_damping(steady_configuration(engine, arguments, first), engine.registry(), ratios);
  if (damping && !arguments.write.empty())
    write_changed(engine.prepared().values, damping->changes, arguments.write, engine.registry());
  Json j;
  j["scene"] = arguments.scene;
  j["sweep"] = sweep.none() ? Json() : Json(sweep.path);
  j["runs"] = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    j["runs"].push_back(modes_json(runs[i]));
    j["runs"].back()["against_next"] = against_json(against[i]);
  }
  if (masses) j["effective_mass"] = effective_mass_json(*masses);
  if (damping) j["damping"] = mounted_damping_json(*damping);
  if (!arguments.out.empty()) write_files(runs, j, arguments, sweep);
  if (arguments.json) {
    print(json_text(j));
  } else {
    for (std::size_t i = 0; i < runs.size(); ++i)
      print((i == 0 ? "" : "\n") + run_text(runs[i], arguments, sweep, against[i]));
    if (masses) print('\n' + effective_mass_text(*masses));
    if (damping) print('\n' + mounted_damping_text(*damping));
    if (damping && !arguments.write.empty()) print("\nwritten to " + arguments.write + '\n');
    if (!arguments.out.empty()) print("\nResults: " + arguments.out + '\n');
  }
  return complain_of(runs, sweep) ? ExitStatus::stopped : ExitStatus::done;
}

std::function<ExitStatus()> add_modes(CLI::App& c) {
  const auto arguments = std::make_shared<ModesArguments>();
  ModesArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.formulations, "--formulations,--formulation", "Formulations; default: the scene's");
  add_configuration(c, a);
  c.add_option("--sweep", a.sweep, "Any number of the scene, or spin.HINGE, over a range")
      ->type_name("PATH=FROM:TO:COUNT");
  c.add_option("--count", a.count, "Modes that are shown (files hold all)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100000}))
      ->capture_default_str();
  c.add_flag("--poles", a.poles, "All eigenvalues, real and complex, in the order of |λ|");
  c.add_flag("--effective-mass", a.masses, "How much of the mass each mode moves where the base shakes");
  c.add_option("--damp", a.damp, "Ratios that the lowest vibrations shall have: finds the bodies' damping for them")
      ->type_name("RATIO,...")
      ->delimiter(',');
  c.add_option("--write", a.write, "File for the scene with the damping that --damp finds; comments are kept")
      ->type_name("FILE");
  c.add_flag("--floquet", a.floquet, "Characteristic exponents over a whole turn, most unstable first");
  c.add_option("--blades", a.blades, "Equal blades seen from where the rotor does not turn: their names, or auto")
      ->type_name("NAME,...")
      ->delimiter(',');
  c.add_option("--period", a.period, "Period of motions and loads [s]; default: that of the hinges' rates")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
  c.add_flag("--as-is", a.as_is, "About the state as it is given, without finding the steady one");
  add_output(c, a, "Folder for modes.csv, modes.json and, of a sweep, modes.svg");
  return [arguments] { return modes(*arguments); };
}

}  // namespace

const Command modes_command = {
    "modes", "Frequencies, damping and shapes of small motions; over a sweep, if wanted",
    "  withy modes scenes/two-link-slew.yaml --lock shoulder,elbow\n"
    "  withy modes scenes/rotating-blade.yaml --spin axle=6 --count 4\n"
    "  withy modes scenes/solar-panel.yaml --as-is --effective-mass\n"
    "  withy modes scenes/two-link-slew.yaml --lock shoulder,elbow --damp 1%,1%,1%\n"
    "  withy modes scenes/rotating-blade.yaml --formulations ruthless,inconsistent,consistent --sweep "
    "spin.axle=0:6:13 --count 4 --out results/campbell",
    &add_modes};

}  // namespace withy::app
