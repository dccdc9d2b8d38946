#include <exception>
#include <new>
#include <string>
#include <variant>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/core/plugin/floating_point.hpp"
#include "withy/program/allocations.hpp"
#include "withy/program/output.hpp"
#include "withy/program/sudden_end.hpp"
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

}  // namespace

int main(int argc, char** argv) {
  withy::program::keep_freed_memory();
  withy::program::watch_for_sudden_ends();
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
  withy::program::end_is_due();
  return static_cast<int>(status);
}
