#include "withy/apps/withy/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

namespace withy::app {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;

extern "C" void remember_interrupt(int) { interrupt_seen = 1; }

}  // namespace

void watch_for_interrupt() {
  struct sigaction action = {};
  action.sa_handler = remember_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

Progress::Progress(std::string label, double end)
    : label_(std::move(label)), end_(end), terminal_(::isatty(STDERR_FILENO) == 1), next_(Clock::now()) {}

Progress::~Progress() {
  if (shown_) static_cast<void>(std::fputs("\r\033[K", stderr));
}

void Progress::at(double t) {
  if (!terminal_ || Clock::now() < next_) return;
  next_ = Clock::now() + std::chrono::milliseconds(100);
  shown_ = true;
  const std::string line =
      fmt::format("\r\033[K{}: {:.3f} of {:g} s ({:.0f} %)", label_, t, end_, end_ > 0 ? 100 * t / end_ : 100.0);
  static_cast<void>(std::fputs(line.c_str(), stderr));
}

}  // namespace withy::app
