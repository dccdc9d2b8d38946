/// \file
/// Several threads that take what is to do from one list.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace withy::study {

/// Calls `work(j)` for each j < jobs at once, 0 on this thread, and comes back when all have. `work` takes the next of
/// what is to do until nothing is left, and lets no exception out. Where the system gives no more threads (a limit of
/// processes or memory), those that are there do all of it: results do not depend on their number.
/// \throws std::bad_alloc
template <class Work>
void work_together(std::size_t jobs, const Work& work) {
  std::vector<std::jthread> helpers;
  helpers.reserve(jobs);
  try {
    for (std::size_t j = 1; j < jobs; ++j) helpers.emplace_back([&work, j] { work(j); });
  } catch (const std::system_error&) {
  }
  work(std::size_t{0});
}

}  // namespace withy::study
