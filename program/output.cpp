#include "withy/program/output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <new>
#include <string>
#include <system_error>

#include "withy/program/colour.hpp"

namespace withy::program {

namespace {

bool complained = false;

void write_out(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw std::system_error(errno, std::generic_category(), "standard output");
}

}  // namespace

void print(std::string_view text) {
  // JSON is read by programs, on a terminal too.
  if (shows_colours(STDOUT_FILENO) && !text.starts_with('{') && !text.starts_with('['))
    write_out(with_outcomes_coloured(text));
  else
    write_out(text);
}

void finish_printing() {
  if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category(), "standard output");
}

void complain(std::string_view text) noexcept {
  complained = true;
  // Where standard error cannot be written there is nobody left to tell: the exit status says it.
  std::string bold;
  try {
    if (shows_colours(STDERR_FILENO)) bold = with_places_bold(text);
  } catch (const std::bad_alloc&) {
    bold.clear();  // without memory the text is written as it is
  }
  const std::string_view shown = bold.empty() ? text : std::string_view(bold);
  static_cast<void>(std::fwrite(shown.data(), 1, shown.size(), stderr));
  if (!text.empty() && text.back() != '\n') static_cast<void>(std::fputc('\n', stderr));
}

bool has_complained() noexcept { return complained; }

}  // namespace withy::program
