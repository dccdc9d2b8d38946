#include "withy/core/sweep/thread_team.hpp"

#include <string>
#include <system_error>

namespace withy::sweep {
namespace {

void pause() noexcept {
#ifdef __SSE2__
  __builtin_ia32_pause();
#endif
}

#ifdef __SSE2__
unsigned arithmetic() noexcept { return __builtin_ia32_stmxcsr(); }
void compute_with(unsigned state) noexcept { __builtin_ia32_ldmxcsr(state); }
#else
unsigned arithmetic() noexcept { return 0; }
void compute_with(unsigned /*state*/) noexcept {}
#endif

/// Turns of a loop with a pause, of some tens of nanoseconds each, before a thread lets others run.
constexpr int spins = 2000;

}  // namespace

ThreadTeam::ThreadTeam(std::size_t members) {
  helpers_.reserve(members);
  try {
    for (std::size_t k = 1; k < members; ++k) helpers_.emplace_back([this, k] { help(k); });
  } catch (const std::system_error& error) {
    end();  // threads that are not joined would end the program
    throw std::system_error(error.code(), "an evaluation cannot begin " + std::to_string(members) + " threads");
  }
}

ThreadTeam::~ThreadTeam() { end(); }

void ThreadTeam::end() noexcept {
  begin(nullptr, nullptr);
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadTeam::begin(Call call, const void* work) noexcept {
  call_ = call;
  work_ = work;
  arithmetic_ = arithmetic();
  done_.store(0, std::memory_order_relaxed);
  // Sequentially consistent, as is what a helper does that goes to sleep: either it sees the work or this sees it.
  begun_.fetch_add(1);
  if (asleep_.load() > 0) begun_.notify_all();
}

void ThreadTeam::wait() noexcept {
  const auto all = static_cast<std::uint32_t>(helpers_.size());
  for (int i = 0; done_.load(std::memory_order_acquire) != all; ++i) {
    if (i < spins) {
      pause();
    } else {
      std::this_thread::yield();
    }
  }
}

void ThreadTeam::help(std::size_t member) noexcept {
  for (std::uint32_t seen = 0;; ++seen) {
    for (int i = 0; i < spins && begun_.load(std::memory_order_acquire) == seen; ++i) pause();
    if (begun_.load() == seen) {
      asleep_.fetch_add(1);
      begun_.wait(seen);
      asleep_.fetch_sub(1);
    }
    if (call_ == nullptr) return;
    compute_with(arithmetic_);
    call_(work_, member);
    done_.fetch_add(1, std::memory_order_release);
  }
}

}  // namespace withy::sweep
