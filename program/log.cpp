#include "withy/program/log.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <ctime>

namespace withy::program {

void log(std::string_view line) {
  using Clock = std::chrono::system_clock;
  const Clock::time_point now = Clock::now();
  const std::time_t second = Clock::to_time_t(now);
  const auto since = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count();
  std::tm day{};
  ::localtime_r(&second, &day);
  fmt::print(stderr, "{:02}:{:02}:{:02}.{:03} {}\n", day.tm_hour, day.tm_min, day.tm_sec, since % 1000, line);
}

}  // namespace withy::program
