#include "withy/program/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <utility>

#include "withy/program/fold.hpp"

namespace withy::program {
namespace {

volatile std::sig_atomic_t interrupt_seen = 0;

extern "C" void remember_interrupt(int) { interrupt_seen = 1; }

}  // namespace

void watch_for_interrupt() {
  struct sigaction action = {};
  action.sa_handler = remember_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  // A batch system's way to end a job, and the end of a terminal, if nohup has not said that it is to be ignored.
  for (const int signal : {SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

bool interrupted() { return interrupt_seen != 0; }

Progress::Progress(std::string label)
    : label_(std::move(label)), terminal_(::isatty(STDERR_FILENO) == 1), began_(Clock::now()), next_(began_) {}

Progress::~Progress() {
  if (shown_) static_cast<void>(std::fputs("\r\033[K", stderr));
}

void Progress::show(const std::string& text) {
  next_ = Clock::now() + std::chrono::milliseconds(100);
  shown_ = true;
  static_cast<void>(std::fputs(fmt::format("\r\033[K{}: {}", label_, text).c_str(), stderr));
}

void Progress::note(const std::string& text) {
  if (!terminal_) return;
  const double passed = std::chrono::duration<double>(Clock::now() - began_).count();
  const std::size_t columns = columns_of(STDERR_FILENO);
  std::string line = fmt::format("{:6.1f} s  {}\n", passed, text);
  if (columns > 0) line = folded(line, columns);
  static_cast<void>(std::fputs(("\r\033[K" + line).c_str(), stderr));
  next_ = Clock::now();  // the line below is due
}

void Progress::begin() {
  if (due()) show("begins");
}

void Progress::at(double t, double end) {
  if (!std::exchange(told_, true)) first_ = t;
  if (!due()) return;
  std::string text = fmt::format("{:.3f} of {:g} s ({:.0f} %)", t, end, end > 0 ? 100 * t / end : 100.0);
  const double passed = std::chrono::duration<double>(Clock::now() - began_).count();
  if (const double rate = (t - first_) / passed; passed > 0.5 && rate > 0)
    text += fmt::format(", {:.3g} s a second, about {:.0f} s left", rate, (end - t) / rate);
  show(text);
}

void Progress::of_points(double done, double all) {
  if (!due()) return;
  const double passed = std::chrono::duration<double>(Clock::now() - began_).count();
  // Seconds have a digit behind the point, what is counted has none.
  const bool counted = done == std::floor(done) && all == std::floor(all);
  std::string text = fmt::format("{:.{}f} of {:g}", done, counted ? 0 : 1, all);
  if (done > 0) text += fmt::format(", about {:.0f} s left", passed / done * (all - done));
  show(text);
}

}  // namespace withy::program
