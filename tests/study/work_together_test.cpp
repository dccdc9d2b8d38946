#include "withy/study/work_together.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <vector>

namespace withy::study {
namespace {

/// Whether each of 1,000 pieces of work is done once by so many threads.
bool all_is_done(std::size_t jobs) {
  std::vector<std::atomic<int>> times(1000);
  std::atomic<std::size_t> next{0};
  work_together(jobs, [&](std::size_t) {
    for (std::size_t k = next++; k < times.size(); k = next++) ++times[k];
  });
  for (const std::atomic<int>& n : times)
    if (n != 1) return false;
  return true;
}

TEST(WorkTogether, DoesAllOfItOnceWithAnyNumberOfThreads) {
  for (const std::size_t jobs : {1, 2, 7}) EXPECT_TRUE(all_is_done(jobs)) << jobs;
}

/// In a process of its own, which has 20 MB more than it uses: room for the stacks of two threads and not of 64.
[[noreturn]] void work_with_little_memory() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{20} << 20);
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
  std::_Exit(all_is_done(64) ? 0 : 1);
}

TEST(WorkTogether, GoesOnWithTheThreadsThatTheSystemGives) {
  EXPECT_EXIT(work_with_little_memory(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace withy::study
