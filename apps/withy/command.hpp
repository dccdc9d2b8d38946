/// \file
/// What the commands of `withy` share: their list, arguments that several take. What they print is described in
/// docs/command-line.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/program/command.hpp"
#include "withy/program/output.hpp"
#include "withy/scene/scene.hpp"

namespace withy::app {

using program::Command;
using program::complain;
using program::ExitStatus;
using program::Options;
using program::print;
using program::taking;

extern const Command run_command, compare_command, inverse_command, terms_command, trade_command, advise_command,
    eval_command, inspect_command, equilibrium_command, linearize_command, response_command, modes_command,
    bench_command, import_command, plugins_command, schema_command, report_command, plot_command, check_command,
    new_command, completion_command, manual_command, fmu_command, tune_command, export_command, sweep_command;

struct CommonArguments {
  std::vector<std::string> plugin_directories;  ///< searched before the program's own
  bool json = false;
  bool verbose = false;  ///< log on standard error what is read, loaded and compiled
};

struct SceneArguments : CommonArguments {
  std::string scene;
  SceneOptions options;
  std::vector<std::string> outputs;  ///< names of columns; those that say what they are are outputs of the scene
};

/// Commands that look at one state of a scene.
struct StateArguments : SceneArguments {
  std::string state;  ///< file; empty: the scene's initial state
};

/// A folder for results.
struct OutputArguments {
  std::string out;     ///< empty: the command's default
  bool force = false;  ///< another result there is replaced
};

/// `--json`.
Options& add_json(Options& options, bool& json);
void add_common(Options& options, CommonArguments& arguments);
/// The scene, `--integrator`, `--set` and what is common to all commands.
void add_scene(Options& options, SceneArguments& arguments);
void add_formulation(Options& options, SceneArguments& arguments);
void add_state(Options& options, StateArguments& arguments);
/// `--out` and `--force`.
void add_output(Options& options, OutputArguments& arguments, const std::string& meaning);

}  // namespace withy::app
