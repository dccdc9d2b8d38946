/// \file
/// What every command of `withy` is: its name, what it is told and how it ends. What they print is described in
/// docs/command-line.md.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "withy/scene/scene.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
class Option;
}  // namespace CLI

namespace withy::app {

/// Exit status of the program, the same for every command.
enum class ExitStatus : int {
  done = 0,
  stopped = 1,      ///< the simulation stopped before its end, with results up to there
  bad_input = 2,    ///< the command line, a scene or a state
  environment = 3,  ///< a plugin, a file that cannot be written, memory
  interrupted = 130
};

/// A command. Its file defines it, with its arguments, its help and its call; command_line.cpp lists it.
struct Command {
  const char* name;
  const char* meaning;   ///< a sentence
  const char* examples;  ///< a line each
  /// Tells the parser what the command takes; what it returns is called once that is read.
  std::function<ExitStatus()> (*add)(CLI::App& parser);
};
extern const Command run_command, compare_command, inverse_command, terms_command, trade_command, advise_command,
    eval_command, inspect_command, equilibrium_command, linearize_command, response_command, modes_command,
    bench_command, import_command, plugins_command, schema_command, report_command, plot_command, check_command,
    new_command, completion_command, manual_command, fmu_command, tune_command, export_command;

struct CommonArguments {
  std::vector<std::string> plugin_directories;  ///< searched before the program's own
  bool json = false;
  bool verbose = false;  ///< log on standard error what is read, loaded and compiled
};

struct SceneArguments : CommonArguments {
  std::string scene;
  SceneOptions options;
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
CLI::Option* add_json(CLI::App& parser, bool& json);
void add_common(CLI::App& parser, CommonArguments& arguments);
/// The scene, `--integrator`, `--set` and what is common to all commands.
void add_scene(CLI::App& parser, SceneArguments& arguments);
void add_formulation(CLI::App& parser, SceneArguments& arguments);
void add_formulations(CLI::App& parser, std::vector<std::string>& formulations, const std::string& names,
                      const std::string& meaning);
void add_state(CLI::App& parser, StateArguments& arguments);
/// `--out` and `--force`.
void add_output(CLI::App& parser, OutputArguments& arguments, const std::string& meaning);

}  // namespace withy::app
