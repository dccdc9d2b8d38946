#include "withy/apps/withy/command_line.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "withy/apps/withy/command_tree.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/sweep.hpp"
#include "withy/scene/names.hpp"

namespace withy::app {

namespace {

constexpr const char* meaning = "Dynamics of trees of rigid and flexible bodies";

/// In the order of the help.
const std::array commands = {&new_command,        &check_command,   &run_command,         &report_command,
                             &plot_command,       &compare_command, &inverse_command,     &terms_command,
                             &trade_command,      &sweep_command,   &advise_command,      &tune_command,
                             &eval_command,       &inspect_command, &equilibrium_command, &linearize_command,
                             &response_command,   &modes_command,   &bench_command,       &import_command,
                             &export_command,     &fmu_command,     &plugins_command,     &schema_command,
                             &completion_command, &manual_command};

/// Which option a word that the parser does not know may have been.
std::string meant_option(const CLI::App& parser, const CLI::ExtrasError& e, int argc, const char* const* argv) {
  std::vector<std::string> known;
  for (const CLI::Option* option : parser.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (!word.starts_with("--") || std::string(e.what()).find(word) == std::string::npos) continue;
    const std::string guess = nearest(word, known);
    if (!guess.empty() && guess != word) return in_quotes(word) + " is no option; did you mean " + guess + "?";
  }
  return {};
}

/// Parses with this parser; what is not the command's to answer is printed, and its status returned.
std::optional<ExitStatus> parse(CLI::App& program, int argc, const char* const* argv) {
  try {
    program.parse(argc, argv);
    return {};
  } catch (const CLI::ExtrasError& e) {
    const std::vector<CLI::App*> chosen = program.get_subcommands();
    const std::string meant = meant_option(chosen.empty() ? program : *chosen.back(), e, argc, argv);
    complain(meant.empty() ? e.what() : meant);
    complain("withy " + (chosen.empty() ? "" : chosen.back()->get_name() + " ") + "--help names what there is");
    return ExitStatus::bad_input;
  } catch (const CLI::ParseError& e) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = program.exit(e, out, err);
    print(out.str());
    complain(err.str());
    return code == 0 ? ExitStatus::done : ExitStatus::bad_input;
  }
}

/// One that names its commands, for its help, its version and what is wrong without a command.
ExitStatus without_command(CLI::App& program, int argc, const char* const* argv) {
  program.require_subcommand(1);
  for (const Command* command : commands) program.add_subcommand(command->name, command->meaning);
  return parse(program, argc, argv).value_or(ExitStatus::done);
}

ExitStatus unknown(const std::string& name) {
  std::vector<std::string> names;
  std::string all;
  for (const Command* command : commands) {
    names.emplace_back(command->name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const std::string guess = nearest(name, names);
  complain(in_quotes(name) + " is no command" + (guess.empty() ? "" : "; did you mean '" + guess + "'?") +
           "\nCommands: " + all + "; withy --help says what they do");
  return ExitStatus::bad_input;
}

}  // namespace

std::unique_ptr<CLI::App> command_tree() {
  auto program = std::make_unique<CLI::App>(meaning, "withy");
  program->set_version_flag("--version", "");
  for (const Command* command : commands) {
    CLI::App& parser = *program->add_subcommand(command->name, command->meaning);
    parser.footer(std::string("Examples:\n") + command->examples);
    static_cast<void>(command->add(parser));
  }
  return program;
}

std::variant<std::function<ExitStatus()>, ExitStatus> read_command_line(int argc, const char* const* argv) {
  CLI::App program(meaning, "withy");
  program.set_version_flag("--version", "withy " WITHY_VERSION);
  program.footer(
      "Examples:\n"
      "  withy run scenes/pendulum.yaml\n"
      "  withy run --help");
  const std::string name = argc > 1 ? argv[1] : "";
  if (name.empty() || name.front() == '-') return without_command(program, argc, argv);
  for (const Command* command : commands) {
    if (name != command->name) continue;
    CLI::App& parser = *program.add_subcommand(command->name, command->meaning);
    parser.footer(std::string("Examples:\n") + command->examples);
    std::function<ExitStatus()> call = command->add(parser);
    if (const auto status = parse(program, argc, argv)) return *status;
    return call;
  }
  return unknown(name);
}

}  // namespace withy::app
