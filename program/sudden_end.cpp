#include "withy/program/sudden_end.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "withy/program/command.hpp"
#include "withy/program/output.hpp"

namespace withy::program {
namespace {

bool due = false;

/// Where the libraries stand that the program was started with: those that come later are plugins, or what these need.
std::vector<ElfW(Addr)>& own_libraries() {
  static std::vector<ElfW(Addr)> places;
  return places;
}

/// "a plugin", with its file where the calls that are under way tell it.
std::string guilty_plugin() {
  std::array<void*, 64> calls{};
  const int count = backtrace(calls.data(), static_cast<int>(calls.size()));
  const std::vector<ElfW(Addr)>& own = own_libraries();
  for (int i = 0; i < count; ++i) {
    Dl_info info{};
    if (dladdr(calls[static_cast<std::size_t>(i)], &info) == 0 || info.dli_fname == nullptr) continue;
    const auto place = reinterpret_cast<ElfW(Addr)>(info.dli_fbase);
    if (std::find(own.begin(), own.end(), place) == own.end()) return fmt::format("the plugin {}", info.dli_fname);
  }
  return "a plugin";
}

/// ": 'text'" of the exception under way, where it has one.
std::string text_of_exception() {
  try {
    if (const std::exception_ptr now = std::current_exception()) std::rethrow_exception(now);
  } catch (const std::exception& e) {
    return fmt::format(" ('{}')", e.what());
  } catch (...) {
    return {};
  }
  return {};
}

/// What the program was at is not done.
void refuse_early_end() {
  if (due) return;
  complain(guilty_plugin() + " has ended the program by a call of exit(): what was asked for is not done");
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

[[noreturn]] void explain_termination() {
  complain(
      fmt::format("{} has let an exception{} out of code that must not let one out, as an evaluation: cannot go on",
                  guilty_plugin(), text_of_exception()));
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

int note_library(dl_phdr_info* library, std::size_t /*size*/, void* /*unused*/) {
  own_libraries().push_back(library->dlpi_addr);
  return 0;
}

}  // namespace

void watch_for_sudden_ends() {
  own_libraries();  // made before, so that it is there while refuse_early_end() runs
  dl_iterate_phdr(&note_library, nullptr);
  std::atexit(refuse_early_end);
  std::at_quick_exit(refuse_early_end);
  std::set_terminate(explain_termination);
  std::signal(SIGXFSZ, SIG_IGN);
}

void end_is_due() noexcept { due = true; }

}  // namespace withy::program
