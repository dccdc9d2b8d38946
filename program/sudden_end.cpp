#include "withy/program/sudden_end.hpp"

#include <csignal>
#include <cstdlib>
#include <exception>

#include "withy/program/command.hpp"
#include "withy/program/output.hpp"

namespace withy::program {
namespace {

bool due = false;

/// What the program was at is not done.
void refuse_early_end() {
  if (due) return;
  complain("a plugin has ended the program by a call of exit(): what was asked for is not done");
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

[[noreturn]] void explain_termination() {
  complain("an exception has left code that must not let one out, as a plugin's evaluation: cannot go on");
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

}  // namespace

void watch_for_sudden_ends() {
  std::atexit(refuse_early_end);
  std::at_quick_exit(refuse_early_end);
  std::set_terminate(explain_termination);
  std::signal(SIGXFSZ, SIG_IGN);
}

void end_is_due() noexcept { due = true; }

}  // namespace withy::program
