#include "withy/program/output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <new>
#include <string>
#include <system_error>

#include "withy/program/colour.hpp"
#include "withy/program/fold.hpp"

namespace withy::program {

namespace {

bool complained = false;

void write_out(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw std::system_error(errno, std::generic_category(), "standard output");
}

}  // namespace

void print(std::string_view text) {
  // JSON, scripts and the manual are read by programs, on a terminal too.
  const std::size_t columns = text.find_first_of("{[#.") == 0 ? 0 : columns_of(STDOUT_FILENO);
  if (columns == 0) return write_out(text);
  const std::string lines = folded(text, columns);
  write_out(shows_colours(STDOUT_FILENO) ? with_outcomes_coloured(lines) : lines);
}

void finish_printing() {
  if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category(), "standard output");
}

void complain(std::string_view text) noexcept {
  complained = true;
  // Where standard error cannot be written there is nobody left to tell: the exit status says it.
  std::string made;
  try {
    if (const std::size_t columns = columns_of(STDERR_FILENO); columns > 0) made = folded(text, columns);
    if (shows_colours(STDERR_FILENO)) made = with_places_bold(made);
  } catch (const std::bad_alloc&) {
    made.clear();  // without memory the text is written as it is
  }
  const std::string_view shown = made.empty() ? text : std::string_view(made);
  static_cast<void>(std::fwrite(shown.data(), 1, shown.size(), stderr));
  if (!text.empty() && text.back() != '\n') static_cast<void>(std::fputc('\n', stderr));
}

bool has_complained() noexcept { return complained; }

}  // namespace withy::program
