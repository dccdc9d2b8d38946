/// \file
/// The commands of `withy`: what each is told and how it ends. What they print is described in docs/command-line.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/scene/scene.hpp"
#include "withy/study/candidates.hpp"

namespace withy::app {

/// Exit status of the program, the same for every command.
enum class ExitStatus : int {
  done = 0,
  stopped = 1,      ///< the simulation stopped before its end, with results up to there
  bad_input = 2,    ///< the command line, a scene or a state
  environment = 3,  ///< a plugin, a file that cannot be written, memory
  interrupted = 130
};

struct CommonArguments {
  std::vector<std::string> plugin_directories;  ///< searched before the program's own
  bool json = false;
  bool verbose = false;  ///< log on standard error what is read, loaded and compiled
};

struct SceneArguments : CommonArguments {
  std::string scene;
  SceneOptions options;
};

struct RunArguments : SceneArguments {
  std::string out;  ///< folder of the results; empty: results/<scene>-<formulation>
  /// When the error against the next model up is estimated: auto (against `quadratic`), always, never.
  std::string estimate = "auto";
  /// Wall time between checkpoints [s]; 0: only where the run is interrupted; not given: 60.
  std::optional<double> checkpoint;
  bool resume = false;  ///< go on from the checkpoint in the folder
};

struct CompareArguments : SceneArguments {
  std::vector<std::string> formulations = {"ruthless", "inconsistent", "consistent", "quadratic"};
  std::string reference = "quadratic";  ///< formulation that the others' errors are measured against
  std::string over;                     ///< `path=value,value,…`: the comparison is made at each value; may be empty
  std::string out;                      ///< folder of the results; empty: none are kept
};

struct InverseArguments : SceneArguments {
  std::string motion;  ///< file with hinge coordinates over time; empty: the scene's motions
  std::string out;     ///< folder of the results; empty: results/<scene>-inverse
};

struct TermsArguments : SceneArguments {
  std::string out;  ///< folder of the results; empty: none are kept
};

/// Values of each axis; their product is the study.
struct TradeAxes {
  std::vector<std::string> formulations;     ///< empty: those that take part in studies
  std::vector<std::string> families = {""};  ///< of bending; empty text: the scene's
  std::vector<int> modes = {1, 2, 3};        ///< of each family that a beam has
  std::vector<std::string> integrators = {"dopri5", "imex"};
  std::vector<double> tolerances = {1e-4, 1e-6};  ///< relative; absolute ones are 1e-2 of them
  std::vector<std::string> over;  ///< `path=value,value,…`; where a limit is sought, one of them `path=from:to[:count]`
};

struct TradeArguments : SceneArguments {
  TradeAxes axes;
  std::string limit;             ///< relative error whose passing is sought along a range in `over`; empty: a trade
  std::string measure = "runs";  ///< what that error is of: runs, frequencies
  std::size_t count = 2;         ///< modes whose frequencies are compared
  std::vector<std::string> lock, spin;  ///< for frequencies: as in ConfigurationArguments
  std::string out;                      ///< folder of the results and of what is finished; empty: none are kept
  std::size_t jobs = 0;                 ///< threads; 0: one a core
};

/// What is advised is the cheapest of these that holds the accuracy.
struct AdviseArguments : SceneArguments {
  std::string accuracy = "1%";
  std::vector<std::string> outputs;        ///< that errors are measured on; empty: hinges and tips
  study::Axes axes = study::usual_axes();  ///< families empty: the scene's, and another where it means the same beams
  std::string write;                       ///< file for the scene as advised; empty: none
};

/// Commands that look at one state of a scene.
struct StateArguments : SceneArguments {
  std::string state;  ///< file; empty: the scene's initial state
};

/// Commands that look at small motions about a state.
struct ConfigurationArguments : StateArguments {
  std::vector<std::string>
      lock;  ///< hinges, or single speeds of them, that are held at the state's coordinates and rates
  std::vector<std::string> spin;  ///< `hinge=rate`: held at that rate
};

struct EquilibriumArguments : ConfigurationArguments {
  std::string out;  ///< file for the state; empty: none
};

struct LinearizeArguments : ConfigurationArguments {
  std::vector<std::string> inputs;   ///< hinges or speeds; `all` is every speed; empty: every hinge
  std::vector<std::string> outputs;  ///< names or their beginnings; empty: every output
};

struct ModesArguments : ConfigurationArguments {
  std::vector<std::string> formulations;  ///< empty: the scene's
  std::string sweep;      ///< `path=a:b:n`, a path of the scene or `spin.hinge`; empty: one configuration
  std::size_t count = 6;  ///< modes that are shown
  bool as_is = false;     ///< about the state as it is given, steady or not
  std::string out;        ///< folder for table and picture; empty: none are kept
};

struct BenchArguments : StateArguments {
  std::vector<std::string> formulations;  ///< `all` is every one found; empty: the scene's
};

/// Files of a finite-element program, and what to reduce them to.
struct ImportArguments : CommonArguments {
  std::string job;          ///< of CalculiX: the files' name without extension
  std::string mesh;         ///< input deck or result file; empty: that of the job
  std::string stiffness;    ///< of Abaqus; empty: the job's
  std::string mass_matrix;  ///< the same
  std::string root;         ///< node set or numbers
  std::vector<std::string> interfaces;
  std::vector<std::string> stations;
  int modes = 10;      ///< fixed-interface modes
  double highest = 0;  ///< [Hz]; 0: none
  std::string out;     ///< empty: <job>.SID_FEM
};

struct PluginsArguments : CommonArguments {
  std::string name;  ///< id or kind/id; empty: all
};

ExitStatus run(const RunArguments& arguments);
ExitStatus compare(const CompareArguments& arguments);
ExitStatus inverse(const InverseArguments& arguments);
ExitStatus terms(const TermsArguments& arguments);
ExitStatus trade(const TradeArguments& arguments);
ExitStatus advise(const AdviseArguments& arguments);
ExitStatus eval(const StateArguments& arguments);
ExitStatus inspect(const StateArguments& arguments);
ExitStatus equilibrium(const EquilibriumArguments& arguments);
ExitStatus linearize(const LinearizeArguments& arguments);
ExitStatus modes(const ModesArguments& arguments);
ExitStatus bench(const BenchArguments& arguments);
ExitStatus import_mesh(const ImportArguments& arguments);
ExitStatus plugins(const PluginsArguments& arguments);
ExitStatus schema(const CommonArguments& arguments);

}  // namespace withy::app
