#include <exception>
#include <functional>
#include <new>
#include <string>
#include <variant>

#include "withy/apps/withy/command_line.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/results/results_error.hpp"

namespace {

using withy::app::ExitStatus;

ExitStatus run_program(int argc, const char* const* argv) {
  const auto asked = withy::app::read_command_line(argc, argv);
  const auto* command = std::get_if<std::function<ExitStatus()>>(&asked);
  const ExitStatus status = command != nullptr ? (*command)() : std::get<ExitStatus>(asked);
  withy::app::finish_printing();
  return status;
}

ExitStatus fail(ExitStatus status, const std::string& why) {
  withy::app::complain(why);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  ExitStatus status = ExitStatus::environment;
  try {
    status = run_program(argc, argv);
  } catch (const withy::SceneError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const withy::app::InputError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const withy::ResultsError& e) {
    status = fail(ExitStatus::bad_input, e.what());
  } catch (const std::bad_alloc&) {
    status = fail(ExitStatus::environment, "not enough memory");
  } catch (const std::exception& e) {
    // A plugin that was refused, a file that cannot be written, a disk that is full.
    status = fail(ExitStatus::environment, e.what());
  }
  return static_cast<int>(status);
}
