#include "withy/apps/withy/commands.hpp"

#include <array>

#include "withy/apps/withy/command.hpp"

namespace withy::app {
namespace {

/// In the order of the help.
constexpr std::array commands = {&new_command,        &check_command,   &run_command,         &report_command,
                                 &plot_command,       &compare_command, &inverse_command,     &terms_command,
                                 &trade_command,      &sweep_command,   &advise_command,      &tune_command,
                                 &eval_command,       &inspect_command, &equilibrium_command, &linearize_command,
                                 &response_command,   &modes_command,   &bench_command,       &import_command,
                                 &export_command,     &fmu_command,     &plugins_command,     &schema_command,
                                 &completion_command, &manual_command};

struct ShellArgument {
  std::string shell;
};

void add_completion(Options& o, ShellArgument& a) {
  o.argument("SHELL", a.shell, "The shell").required().among({"bash", "zsh"});
}

ExitStatus completion(const ShellArgument& arguments) {
  const program::CommandDescription all = description_of(withy_program());
  print(arguments.shell == "bash" ? bash_completion(all) : zsh_completion(all));
  return ExitStatus::done;
}

program::Call add_manual(Options&) {
  return [] {
    print(manual_page(description_of(withy_program()), withy_program().version));
    return ExitStatus::done;
  };
}

}  // namespace

const program::Program& withy_program() {
  static const program::Program all = {"withy", "Dynamics of trees of rigid and flexible bodies", WITHY_VERSION,
                                       "  withy run scenes/pendulum.yaml\n"
                                       "  withy run --help",
                                       commands};
  return all;
}

const Command completion_command = {"completion",
                                    "Print a script by which a shell completes withy's commands and options",
                                    "  withy completion bash\n"
                                    "  withy completion zsh",
                                    &taking<ShellArgument, add_completion, completion>};

const Command manual_command = {"manual", "Print the manual page, withy.1", "  withy manual", &add_manual};

}  // namespace withy::app
