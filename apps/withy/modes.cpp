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

/// What is asked but for what the scene has to be there for: what is held, and where.
study::ModesQuestion question_of(const ModesArguments& arguments) {
  study::ModesQuestion question;
  question.formulations = arguments.formulations;
  question.sweep = study::parse_sweep(arguments.sweep, "sweep");
  question.start = [&](const study::Prepared& prepared) { return read_state(prepared, arguments.state); };
  question.wish = study::turning_wish(arguments.floquet, arguments.blades, arguments.period);
  question.as_is = arguments.as_is;
  question.compared = arguments.count;
  question.masses = arguments.masses;
  question.damp = study::read_damping_ratios(arguments.damp);
  check_question(question);
  return question;
}

ExitStatus modes(const ModesArguments& arguments) {
  study::ModesQuestion question = question_of(arguments);
  if (!arguments.write.empty() && question.damp.empty())
    throw InputError("--write writes what --damp finds: give that too");
  const Engine engine(arguments);
  check_write(arguments.write, arguments, engine);
  const auto folder =
      take_folder(arguments, "modes", provenance_of(engine.scene(), engine.plugins()),
                  {"modes.json", "modes.csv", "modes.svg", "blades.csv", "blades.svg", report_name}, arguments.state);
  question.holding = study::read_holding(engine.model(), arguments.lock, arguments.spin);
  const study::ModesFound all = find_modes(engine.prepared(), engine.registry(), question, study_control);
  if (all.interrupted && all.runs.empty()) return ExitStatus::interrupted;
  const study::Sweep& sweep = question.sweep;
  const nlohmann::ordered_json j = modes_study_json(arguments.scene, sweep, all);
  if (!arguments.out.empty())
    write_modes(arguments.out, all.runs, j, "Modes of " + arguments.scene, sweep, arguments.count);
  if (arguments.json) {
    print(json_text(j));
  } else {
    print(modes_study_text(arguments.scene, sweep, all, arguments.count, arguments.poles));
    if (all.masses) print('\n' + effective_mass_text(*all.masses));
    if (all.damping) print('\n' + mounted_damping_text(*all.damping));
    if (!arguments.out.empty()) print(folder_text(arguments.out));
  }
  if (all.damping && !arguments.write.empty()) {  // once all is told that was found
    write_changed(engine.prepared().values, all.damping->changes, arguments.write, engine.registry());
    if (!arguments.json) print("\nwritten to " + arguments.write + '\n');
  }
  if (const std::string& closing = all.runs.front().points.front().closing; !closing.empty()) complain(closing);
  const std::vector<std::string> problems = study::modes_problems(all.runs, sweep);
  for (const std::string& problem : problems) complain(problem);
  if (all.interrupted) return ExitStatus::interrupted;
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
    "modes", "Frequencies, damping and mode shapes of small motions; also over a sweep",
    "  withy modes scenes/two-link-slew.yaml --lock shoulder,elbow\n"
    "  withy modes scenes/rotating-blade.yaml --spin axle=6 --count 4\n"
    "  withy modes scenes/solar-panel.yaml --as-is --effective-mass\n"
    "  withy modes scenes/two-link-slew.yaml --lock shoulder,elbow --damp 1%,1%,1%\n"
    "  withy modes scenes/rotating-blade.yaml --formulations ruthless,inconsistent,consistent --sweep "
    "spin.axle=0:6:13 --count 4 --out results/campbell",
    &taking<ModesArguments, add_modes, modes>};

}  // namespace withy::app
