#include "withy/program/sudden_end.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <string>

#include "withy/program/command.hpp"
#include "withy/program/output.hpp"

namespace withy::program {
namespace {

bool due = false;

/// Where the libraries stand that the program was started with: those that come later are plugins, or what these need.
/// No memory is asked for, of which there may be none left.
struct Libraries {
  std::array<ElfW(Addr), 256> places{};
  std::size_t count = 0;
  /// Where there are more than places, nobody knows, and no plugin is named.
  [[nodiscard]] bool has(ElfW(Addr) place) const {
    const auto end = places.begin() + static_cast<std::ptrdiff_t>(count);
    return count == places.size() || std::find(places.begin(), end, place) != end;
  }
};
Libraries own_libraries;

/// "a plugin", with its file where the calls that are under way tell it.
std::string guilty_plugin() {
  std::array<void*, 64> calls{};
  const int count = backtrace(calls.data(), static_cast<int>(calls.size()));
  for (int i = 0; i < count; ++i) {
    Dl_info info{};
    if (dladdr(calls[static_cast<std::size_t>(i)], &info) == 0 || info.dli_fname == nullptr) continue;
    const auto place = reinterpret_cast<ElfW(Addr)>(info.dli_fbase);
    if (!own_libraries.has(place)) return fmt::format("the plugin {}", info.dli_fname);
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

/// Says a plugin's deed as well as memory allows, and ends the program.
template <class Words>
[[noreturn]] void end_with(Words&& words, const char* without_memory) noexcept {
  try {
    complain(words());
  } catch (...) {
    complain(without_memory);
  }
  std::_Exit(static_cast<int>(ExitStatus::environment));
}

/// What the program was at is not done.
void refuse_early_end() {
  if (due) return;
  end_with(
      [] { return guilty_plugin() + " has ended the program by a call of exit(): what was asked for is not done"; },
      "a plugin has ended the program by a call of exit(): what was asked for is not done");
}

[[noreturn]] void explain_termination() {
  end_with(
      [] {
        return fmt::format(
            "{} has let an exception{} out of code that must not let one out, as an evaluation: cannot go on",
            guilty_plugin(), text_of_exception());
      },
      "an exception has left code that must not let one out, as a plugin's evaluation: cannot go on");
}

int note_library(dl_phdr_info* library, std::size_t /*size*/, void* /*unused*/) {
  if (own_libraries.count < own_libraries.places.size())
    own_libraries.places[own_libraries.count++] = library->dlpi_addr;
  return 0;
}

}  // namespace

void watch_for_sudden_ends() {
  dl_iterate_phdr(&note_library, nullptr);
  std::atexit(refuse_early_end);
  std::at_quick_exit(refuse_early_end);
  std::set_terminate(explain_termination);
  std::signal(SIGXFSZ, SIG_IGN);
}

void end_is_due() noexcept { due = true; }

}  // namespace withy::program
