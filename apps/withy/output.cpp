#include "withy/apps/withy/output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace withy::app {

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    throw std::system_error(errno, std::generic_category(), "standard output");
}

void finish_printing() {
  if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category(), "standard output");
}

void complain(std::string_view text) noexcept {
  // Where standard error cannot be written there is nobody left to tell: the exit status says it.
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
  if (!text.empty() && text.back() != '\n') static_cast<void>(std::fputc('\n', stderr));
}

}  // namespace withy::app
