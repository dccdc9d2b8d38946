#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <variant>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/program/output.hpp"
#include "withy/results/results_error.hpp"

namespace {

using withy::program::ExitStatus;

ExitStatus run_program(int argc, const char* const* argv) {
  const auto asked = read_command_line(withy::app::withy_program(), argc, argv);
  const auto* command = std::get_if<withy::program::Call>(&asked);
  const ExitStatus status = command != nullptr ? (*command)() : std::get<ExitStatus>(asked);
  withy::program::finish_printing();
  if (status == ExitStatus::interrupted && !withy::program::has_complained()) withy::program::complain("interrupted");
  return status;
}

ExitStatus fail(ExitStatus status, const std::string& why) {
  withy::program::complain(why);
  return status;
}

bool returned = false;  ///< main has come to its end: whatever runs after it is no part of a command

/// Nothing but a plugin ends the program before its end, and what it was at is then not done.
void refuse_early_end() {
  if (returned) return;
  withy::program::complain("a plugin has ended the program by a call of exit(): what was asked for is not done");
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

[[noreturn]] void explain_termination() {
  withy::program::complain(
      "an exception has left code that must not let one out, as a plugin's evaluation: cannot go on");
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

/// What would end the program without a word or a status of its own.
void watch_for_ends() {
  std::atexit(refuse_early_end);
  std::at_quick_exit(refuse_early_end);
  std::set_terminate(explain_termination);
  std::signal(SIGXFSZ, SIG_IGN);  // a write past a limit of the file's size then fails, and is reported as any other
}

}  // namespace

int main(int argc, char** argv) {
  watch_for_ends();
  ExitStatus status = ExitStatus::environment;
  try {
    withy::FloatingPointGuard arithmetic;
    status = run_program(argc, argv);
    arithmetic.check("a plugin");
  } catch (const withy::SceneError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const withy::study::OptionError& e) {
    status = fail(ExitStatus::bad_input, std::string("--") + e.what());
  } catch (const withy::app::InputError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const withy::ResultsError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const std::bad_alloc&) {
    status = fail(ExitStatus::environment, "not enough memory");
  } catch (const std::exception& e) {
    // A plugin that was refused, a file that cannot be written, a disk that is full.
    status = fail(ExitStatus::environment, e.what());
  } catch (...) {
    status = fail(ExitStatus::environment, "a plugin throws what is no exception of C++");
  }
  returned = true;
  return static_cast<int>(status);
}
