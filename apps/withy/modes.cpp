#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/results/effective_mass_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/modes_text.hpp"
#include "withy/results/mounted_damping_files.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/study/formulation_modes.hpp"
#include "withy/study/variation_text.hpp"

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

study::ModesFound found(const Engine& engine, const ModesArguments& arguments, const study::Sweep& sweep) {
  study::ModesQuestion question;
  question.formulations = arguments.formulations;
  question.sweep = sweep;
  question.holding = study::read_holding(engine.model(), arguments.lock, arguments.spin);
  question.start = [&](const study::Prepared& prepared) { return read_state(prepared, arguments.state); };
  question.wish = wish_of(arguments);
  question.as_is = arguments.as_is;
  question.compared = arguments.count;
  return find_modes(engine.prepared(), engine.registry(), question, study_control);
}

/// The steady state that the modes are about.
study::Configuration steady_configuration(const Engine& engine, const ModesArguments& arguments,
                                          const study::ModesAt& at) {
  study::Configuration c = configuration_of(engine, arguments);
  if (at.steady) c.set_state(at.steady->steady.state);
  return c;
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
  const study::Sweep sweep = study::parse_sweep(arguments.sweep, "sweep");
  require_one_configuration(arguments, sweep);
  const std::vector<double> ratios = study::read_damping_ratios(arguments.damp);
  if (!arguments.write.empty() && ratios.empty()) throw InputError("--write writes what --damp finds: give that too");
  const Engine engine(arguments);
  check_write(arguments.write, arguments, engine);
  const auto folder = take_folder(arguments, "modes", provenance_of(engine.scene(), engine.plugins()),
                                  {"modes.json", "modes.csv", "modes.svg", "blades.csv", "blades.svg", report_name});
  const study::ModesFound all = found(engine, arguments, sweep);
  if (all.interrupted) return ExitStatus::interrupted;
  const study::ModesAt& first = all.runs.front().points.front();
  std::optional<study::EffectiveMasses> masses;
  std::optional<study::MountedDamping> damping;
  if (first.problem.empty() && arguments.masses)
    masses = study::effective_masses(steady_configuration(engine, arguments, first));
  if (first.problem.empty() && !ratios.empty())
    damping = study::mounted_damping(steady_configuration(engine, arguments, first), engine.registry(), ratios);
  nlohmann::ordered_json j = modes_study_json(arguments.scene, sweep, all);
  if (masses) j["effective_mass"] = effective_mass_json(*masses);
  if (damping) j["damping"] = mounted_damping_json(*damping);
  if (!arguments.out.empty())
    write_modes(arguments.out, all.runs, j, "Modes of " + arguments.scene, sweep, arguments.count);
  if (arguments.json) {
    print(json_text(j));
  } else {
    print(modes_study_text(arguments.scene, sweep, all, arguments.count, arguments.poles));
    if (masses) print('\n' + effective_mass_text(*masses));
    if (damping) print('\n' + mounted_damping_text(*damping));
    if (!arguments.out.empty()) print(folder_text(arguments.out));
  }
  if (damping && !arguments.write.empty()) {  // once all is told that was found
    write_changed(engine.prepared().values, damping->changes, arguments.write, engine.registry());
    if (!arguments.json) print("\nwritten to " + arguments.write + '\n');
  }
  const std::vector<std::string> problems = study::modes_problems(all.runs, sweep);
  for (const std::string& problem : problems) complain(problem);
  return problems.empty() ? ExitStatus::done : ExitStatus::stopped;
}

void add_modes(Options& o, ModesArguments& a) {
  add_scene(o, a);
  o.list("--formulations,--formulation", a.formulations, "ID,ID,...", "Formulations; default: the scene's");
  add_configuration(o, a);
  o.value("--sweep", a.sweep, "PATH=FROM:TO:COUNT", "Any number of the scene, or spin.HINGE, over a range");
  o.value("--count", a.count, "N", "Modes that are shown (files hold all)")
      .between(std::size_t{1}, std::size_t{100000})
      .with_default();
  o.flag("--poles", a.poles, "All eigenvalues, real and complex, in the order of |λ|");
  o.flag("--effective-mass", a.masses, "How much of the mass each mode moves where the base shakes");
  o.list("--damp", a.damp, "RATIO,...",
         "Ratios that the lowest vibrations shall have: finds the bodies' damping for them");
  o.value("--write", a.write, "FILE", "File for the scene with the damping that --damp finds; comments are kept");
  o.flag("--floquet", a.floquet, "Characteristic exponents over a whole turn, most unstable first");
  o.list("--blades", a.blades, "NAME,...",
         "Equal blades seen from where the rotor does not turn: their names, or auto");
  o.value("--period", a.period, "SECONDS", "Period of motions and loads [s]; default: that of the hinges' rates")
      .positive();
  o.flag("--as-is", a.as_is, "About the state as it is given, without finding the steady one");
  add_output(o, a, "Folder for modes.csv, modes.json, of a sweep modes.svg; with --blades also blades.csv and .svg");
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
    &taking<ModesArguments, add_modes, modes>};

}  // namespace withy::app
