#include "withy/apps/withy/command_line.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <string>

#include "withy/apps/withy/output.hpp"

namespace withy::app {
namespace {

constexpr char scene_to_run[] = "SCENE";

void add_common(CLI::App& command, CommonArguments& a) {
  command.add_option("--plugins", a.plugin_directories, "Folder with plugins, searched before the program's own")
      ->type_name("DIR")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  command.add_flag("--json", a.json, "Give the result as JSON on standard output");
  command.add_flag("-v,--verbose", a.verbose, "Log on standard error what is read, loaded and compiled");
}

void add_scene(CLI::App& command, SceneArguments& a) {
  command.add_option(scene_to_run, a.scene, "Scene file (YAML or JSON)")->required();
  command.add_option("--integrator", a.options.integrator, "Integrator, in place of the scene's")->type_name("ID");
  command.add_option("--set", a.options.overrides, "Change a value of the scene before it is checked; repeatable")
      ->type_name("PATH=VALUE")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  add_common(command, a);
}

void add_formulation(CLI::App& command, SceneArguments& a) {
  command.add_option("--formulation", a.options.formulation, "Formulation, in place of the scene's")->type_name("ID");
}

void add_formulations(CLI::App& command, std::vector<std::string>& formulations, const std::string& names,
                      const std::string& meaning) {
  command.add_option(names, formulations, meaning)->type_name("ID,ID,...")->delimiter(',');
}

void add_state(CLI::App& command, StateArguments& a) {
  command.add_option("--state", a.state, "State file (JSON or YAML); default: the scene's initial state")
      ->type_name("FILE");
}

void add_configuration(CLI::App& command, ConfigurationArguments& a) {
  command.add_option("--at,--state", a.state, "State file (JSON or YAML); default: the scene's initial state")
      ->type_name("FILE");
  command.add_option("--lock", a.lock, "Hinges that are held, at the state's coordinates and rates")
      ->type_name("HINGE,HINGE,...")
      ->delimiter(',');
  command.add_option("--spin", a.spin, "Hinges held at a constant rate, in rad/s, m/s or with a unit")
      ->type_name("HINGE=RATE,...")
      ->delimiter(',');
}

/// Commands and what they will be called with: made by the parser, called after it.
class Commands {
 public:
  explicit Commands(CLI::App& program) : program_(program) {}

  /// Adds a command whose arguments live as long as this object.
  template <class Arguments>
  Arguments& add(const std::string& name, const std::string& meaning, const std::string& examples,
                 ExitStatus (*function)(const Arguments&), CLI::App*& command) {
    command = program_.add_subcommand(name, meaning);
    command->footer("Examples:\n" + examples);
    auto arguments = std::make_shared<Arguments>();
    entries_.push_back({command, [arguments, function] { return function(*arguments); }});
    return *arguments;
  }

  [[nodiscard]] std::function<ExitStatus()> chosen() const {
    for (const Entry& e : entries_)
      if (e.command->parsed()) return e.call;
    return {};
  }

 private:
  struct Entry {
    CLI::App* command;
    std::function<ExitStatus()> call;
  };
  CLI::App& program_;
  std::vector<Entry> entries_;
};

void add_import(Commands& commands) {
  CLI::App* c = nullptr;
  auto& a = commands.add<ImportArguments>(
      "import", "Reduce a finite-element mesh to a modal body",
      "  withy import scenes/meshes/cantilever --root ROOT --interface TIP --modes 6\n"
      "  withy import scenes/meshes/cantilever --root ROOT --station 85 --modes 4 --out boom.SID_FEM",
      import_mesh, c);
  c->add_option("JOB", a.job, "Name of the job: JOB.inp, and of CalculiX JOB.sti, JOB.mas and JOB.dof")->required();
  c->add_option("--mesh", a.mesh, "Input deck or .frd file with the nodes; default: JOB.inp")->type_name("FILE");
  c->add_option("--stiffness", a.stiffness, "Stiffness matrix of Abaqus (*_STIF*.mtx)")->type_name("FILE");
  c->add_option("--mass", a.mass_matrix, "Mass matrix of Abaqus (*_MASS*.mtx)")->type_name("FILE");
  c->add_option("--root", a.root, "Nodes that are clamped: a node set, or numbers separated by commas")
      ->type_name("NODES")
      ->required();
  const auto several = [&](const char* name, std::vector<std::string>& value, const char* meaning) {
    c->add_option(name, value, meaning)
        ->type_name("NODES")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->expected(1)
        ->allow_extra_args(false);
  };
  several("--interface", a.interfaces,
          "Nodes to attach to, a rigid section with static modes: a set, a node, or name=17,18,19; repeatable");
  several("--station", a.stations, "A node to attach to without modes of its own; repeatable");
  c->add_option("--modes", a.modes, "Number of normal modes with the interfaces held")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
  c->add_option("--highest", a.highest, "Drop modes of the reduced body above this frequency [Hz]")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber);
  c->add_option("--out", a.out, "File of Standard Input Data; default: JOB.SID_FEM")->type_name("FILE");
  add_common(*c, a);
}

void add_advise(Commands& commands) {
  CLI::App* c = nullptr;
  auto& a = commands.add<AdviseArguments>(
      "advise", "Find the cheapest model and integration that hold an accuracy",
      "  withy advise scenes/pendulum.yaml --accuracy 1%\n"
      "  withy advise scenes/two-link-slew.yaml --set time.end=0.5 --accuracy 1mm,0.1deg --output payload.tip,elbow",
      advise, c);
  add_scene(*c, a);
  const auto axis = [&](const char* name, auto& values, const char* type, const char* meaning) {
    c->add_option(name, values, meaning)->type_name(type)->delimiter(',');
  };
  c->add_option(
       "--accuracy", a.accuracy,
       "Greatest error of the outputs: a share of the greatest way of any of them, a length, an angle, or several")
      ->type_name("A,...")
      ->capture_default_str();
  axis("--outputs,--output", a.outputs, "NAME,...",
       "What the accuracy is asked of: hinges, BODY.tip, BODY.tip.deflection; default: all free hinges and tips");
  axis("--formulations,--formulation", a.axes.formulations, "ID,...",
       "Formulations to choose from; default: all that take part in studies, plugins' too");
  axis("--families,--family", a.axes.families, "ID,...",
       "Mode families of bending to choose from; default: the scene's, and orthogonal-polynomials where they are the "
       "same beams");
  axis("--modes", a.axes.modes, "N,...", "Modes of each family of a beam to choose from; default: 1,2,3,4");
  axis("--integrators", a.axes.integrators, "ID,...",
       "Integrators to choose from, with a relative tolerance; default: dopri5,dop853,imex");
  axis("--tolerances", a.axes.tolerances, "R,...",
       "Relative tolerances to choose from; default: 1e-2,1e-3,1e-4,1e-5,1e-6");
  c->add_option("--write", a.write, "File for the scene with what is advised; comments are kept")->type_name("FILE");
}

void add_commands(Commands& commands) {
  CLI::App* c = nullptr;

  auto& run_arguments = commands.add<RunArguments>("run", "Simulate a scene",
                                                   "  withy run scenes/two-link-slew.yaml\n"
                                                   "  withy run scenes/two-link-slew.yaml --formulation ruthless "
                                                   "--set loads.slew.time_scale=1.2 --out results/fast\n"
                                                   "  withy run scenes/pendulum.yaml --checkpoint 10",
                                                   run, c);
  add_scene(*c, run_arguments);
  add_formulation(*c, run_arguments);
  c->add_option("--out", run_arguments.out, "Folder of the results; default: results/<scene>-<formulation>")
      ->type_name("DIR");
  c->add_option("--estimate", run_arguments.estimate,
                "Estimate the error against the next model up: auto (where that is quadratic), always, never")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();

  c->add_option("--checkpoint", run_arguments.checkpoint,
                "Wall time between checkpoints; 0: only where the run is interrupted; default: 60")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber);
  c->add_flag("--resume", run_arguments.resume,
              "Go on from the checkpoint in the folder of the results: the same command as before, and this");

  auto& compare_arguments =
      commands.add<CompareArguments>("compare", "Simulate a scene in several formulations, side by side",
                                     "  withy compare scenes/two-link-slew.yaml\n"
                                     "  withy compare scenes/two-link-slew.yaml --formulations ruthless,quadratic "
                                     "--over loads.slew.time_scale=1.0,1.2 --out results/comparison",
                                     compare, c);
  add_scene(*c, compare_arguments);
  add_formulations(*c, compare_arguments.formulations, "--formulations,--formulation",
                   "Formulations; default: ruthless,inconsistent,consistent,quadratic");
  c->add_option("--reference", compare_arguments.reference, "Formulation the errors are measured against")
      ->type_name("ID")
      ->capture_default_str();
  c->add_option("--over", compare_arguments.over, "Compare at each of these values of the scene")
      ->type_name("PATH=VALUE,VALUE,...");
  c->add_option("--out", compare_arguments.out, "Folder for results and pictures; default: nothing is kept")
      ->type_name("DIR");

  auto& inverse_arguments = commands.add<InverseArguments>(
      "inverse", "Efforts that hinges need to follow their motions, flexible bodies swinging along",
      "  withy inverse scenes/spin-up.yaml\n"
      "  withy inverse scenes/two-link-slew.yaml --motion scenes/motions/two-link-pick.csv --set loads={} "
      "--out results/pick",
      inverse, c);
  add_scene(*c, inverse_arguments);
  add_formulation(*c, inverse_arguments);
  c->add_option("--motion", inverse_arguments.motion,
                "CSV file with columns t[s] and hinge coordinates, in the place of the scene's motions")
      ->type_name("FILE");
  c->add_option("--out", inverse_arguments.out, "Folder of the results; default: results/<scene>-inverse")
      ->type_name("DIR");

  auto& terms_arguments =
      commands.add<TermsArguments>("terms", "Measure the terms of the equations of motion along a run",
                                   "  withy terms scenes/two-link-slew.yaml\n"
                                   "  withy terms scenes/two-link-slew.yaml --formulation ruthless "
                                   "--set loads.slew.time_scale=1.2 --out results/terms",
                                   terms, c);
  add_scene(*c, terms_arguments);
  add_formulation(*c, terms_arguments);
  c->add_option("--out", terms_arguments.out, "Folder for table, series and picture; default: nothing is kept")
      ->type_name("DIR");

  auto& trade_arguments = commands.add<TradeArguments>(
      "trade", "Weigh error against cost over formulations, modes, integrators and tolerances",
      "  withy trade scenes/screw.yaml --formulations ruthless,quadratic --modes 1,2\n"
      "  withy trade scenes/two-link-slew.yaml --set time.end=1 --modes 2 --tolerances 1e-4 "
      "--over loads.slew.time_scale=0.5,1 --out results/trade\n"
      "  withy trade scenes/rotating-blade.yaml --measure frequencies --limit 1% --over spin.axle=0:3.5 "
      "--formulations ruthless,inconsistent,quadratic --modes 2",
      trade, c);
  add_scene(*c, trade_arguments);
  add_formulations(*c, trade_arguments.axes.formulations, "--formulations,--formulation",
                   "Formulations; default: all that take part in studies, plugins' too");
  c->add_option("--families,--family", trade_arguments.axes.families, "Mode families of bending; default: the scene's")
      ->type_name("ID,ID,...")
      ->delimiter(',');
  c->add_option("--modes", trade_arguments.axes.modes, "Modes of each family of a beam; default: 1,2,3")
      ->type_name("N,N,...")
      ->delimiter(',');
  c->add_option("--integrators", trade_arguments.axes.integrators,
                "Integrators with a relative tolerance; default: dopri5,imex")
      ->type_name("ID,ID,...")
      ->delimiter(',');
  c->add_option("--tolerances", trade_arguments.axes.tolerances, "Relative tolerances; default: 1e-4,1e-6")
      ->type_name("R,R,...")
      ->delimiter(',');
  c->add_option("--over", trade_arguments.axes.over, "Trade at each of these values of the scene; repeatable")
      ->type_name("PATH=VALUE,VALUE,...")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  c->add_option("--limit", trade_arguments.limit,
                "Find where along --over PATH=FROM:TO[:COUNT] each model's error passes this share, as 1%")
      ->type_name("SHARE");
  c->add_option("--measure", trade_arguments.measure, "With --limit: errors of runs, or of frequencies")
      ->type_name("WHAT")
      ->check(CLI::IsMember({"runs", "frequencies"}))
      ->capture_default_str();
  c->add_option("--count", trade_arguments.count, "Lowest modes whose frequencies are compared")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  c->add_option("--lock", trade_arguments.lock, "Of frequencies: hinges that are held")
      ->type_name("HINGE,HINGE,...")
      ->delimiter(',');
  c->add_option("--spin", trade_arguments.spin, "Of frequencies: hinges held at a constant rate")
      ->type_name("HINGE=RATE,...")
      ->delimiter(',');
  c->add_option("--jobs", trade_arguments.jobs, "Points run at once; default: one a core")->type_name("N");
  c->add_option("--out", trade_arguments.out,
                "Folder for table and picture, and for finished points: the same command continues")
      ->type_name("DIR");

  add_advise(commands);

  auto& eval_arguments = commands.add<StateArguments>(
      "eval", "Evaluate the equations of motion at a state, as JSON",
      "  withy eval scenes/two-link-slew.yaml\n"
      "  withy eval scenes/two-link-slew.yaml --state scenes/states/two-link-bent.json --formulation consistent",
      eval, c);
  add_scene(*c, eval_arguments);
  add_formulation(*c, eval_arguments);
  add_state(*c, eval_arguments);

  auto& inspect_arguments =
      commands.add<StateArguments>("inspect", "Show what a scene is made of and what its compilation saved",
                                   "  withy inspect scenes/two-link-slew.yaml", inspect, c);
  add_scene(*c, inspect_arguments);
  add_formulation(*c, inspect_arguments);
  add_state(*c, inspect_arguments);

  auto& equilibrium_arguments = commands.add<EquilibriumArguments>(
      "equilibrium", "Find the state that stays as it is: at rest, or spinning steadily",
      "  withy equilibrium scenes/rotating-blade.yaml --spin axle=6\n"
      "  withy equilibrium scenes/two-link-slew.yaml --lock shoulder,elbow --set gravity.1=-9.81 --out bent.json",
      equilibrium, c);
  add_scene(*c, equilibrium_arguments);
  add_formulation(*c, equilibrium_arguments);
  add_configuration(*c, equilibrium_arguments);
  c->add_option("--out", equilibrium_arguments.out, "File for the state, as --at, --state and `initial` read it")
      ->type_name("FILE");

  auto& linearize_arguments = commands.add<LinearizeArguments>(
      "linearize", "Matrices A, B, C, D of small motions about a state, for control design, as JSON",
      "  withy linearize scenes/two-link-slew.yaml --at scenes/states/two-link-bent.json\n"
      "  withy linearize scenes/two-link-slew.yaml --inputs shoulder --outputs shoulder,elbow.0.rate,link2.tip",
      linearize, c);
  add_scene(*c, linearize_arguments);
  add_formulation(*c, linearize_arguments);
  add_configuration(*c, linearize_arguments);
  c->add_option("--inputs", linearize_arguments.inputs,
                "Hinges whose efforts are inputs, or all: every generalized speed; default: every free hinge")
      ->type_name("HINGE,...")
      ->delimiter(',');
  c->add_option("--outputs", linearize_arguments.outputs,
                "Hinge coordinates (elbow.0), rates (elbow.0.rate), tips (link2.tip.y); default: all")
      ->type_name("NAME,...")
      ->delimiter(',');

  auto& modes_arguments = commands.add<ModesArguments>(
      "modes", "Frequencies, damping and shapes of small motions; over a sweep, if wanted",
      "  withy modes scenes/two-link-slew.yaml --lock shoulder,elbow\n"
      "  withy modes scenes/rotating-blade.yaml --spin axle=6 --count 4\n"
      "  withy modes scenes/rotating-blade.yaml --formulations ruthless,inconsistent,consistent --sweep "
      "spin.axle=0:6:13 --count 4 --out results/campbell",
      modes, c);
  add_scene(*c, modes_arguments);
  add_formulations(*c, modes_arguments.formulations, "--formulations,--formulation",
                   "Formulations; default: the scene's");
  add_configuration(*c, modes_arguments);
  c->add_option("--sweep", modes_arguments.sweep, "Any number of the scene, or spin.HINGE, over a range")
      ->type_name("PATH=FROM:TO:COUNT");
  c->add_option("--count", modes_arguments.count, "Modes that are shown (files hold all)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100000}))
      ->capture_default_str();
  c->add_flag("--as-is", modes_arguments.as_is, "About the state as it is given, without finding the steady one");
  c->add_option("--out", modes_arguments.out, "Folder for modes.csv, modes.json and, of a sweep, modes.svg")
      ->type_name("DIR");

  auto& bench_arguments =
      commands.add<BenchArguments>("bench", "Time one evaluation of the equations of motion, as JSON",
                                   "  withy bench scenes/two-link-slew.yaml\n"
                                   "  withy bench scenes/two-link-slew.yaml --formulation ruthless,quadratic",
                                   bench, c);
  add_scene(*c, bench_arguments);
  add_formulations(*c, bench_arguments.formulations, "--formulation,--formulations",
                   "One formulation, several, or all; default: the scene's");
  add_state(*c, bench_arguments);

  add_import(commands);

  auto& plugins_arguments =
      commands.add<PluginsArguments>("plugins", "List the plugins found, or describe one with its options",
                                     "  withy plugins\n"
                                     "  withy plugins quadratic",
                                     plugins, c);
  c->add_option("NAME", plugins_arguments.name, "Id of a plugin, or kind/id");
  add_common(*c, plugins_arguments);

  auto& schema_arguments = commands.add<CommonArguments>("schema", "Print the JSON Schema of scenes, for editors",
                                                         "  withy schema", schema, c);
  add_common(*c, schema_arguments);
}

}  // namespace

std::variant<std::function<ExitStatus()>, ExitStatus> read_command_line(int argc, const char* const* argv) {
  CLI::App program("Dynamics of trees of rigid and flexible bodies", "withy");
  program.set_version_flag("--version", "withy " WITHY_VERSION);
  program.require_subcommand(1);
  program.footer(
      "Examples:\n"
      "  withy run scenes/pendulum.yaml\n"
      "  withy run --help");
  Commands commands(program);
  add_commands(commands);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = program.exit(e, out, err);
    print(out.str());
    complain(err.str());
    return code == 0 ? ExitStatus::done : ExitStatus::bad_input;
  }
  return commands.chosen();
}

}  // namespace withy::app
