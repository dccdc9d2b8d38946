/// \file
/// Threads that take up a piece of work within a microsecond, again and again.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace withy::sweep {

/// Helpers of a thread that calls, computing as it does: with its rounding and its denormals. Between two pieces of
/// work they spin for some tens of microseconds, then they sleep: steps of an integrator keep them awake, and a program
/// that does something else has its processors for itself.
class ThreadTeam {
 public:
  /// \param members at least 1, the caller among them
  /// \throws std::system_error where the system gives no more threads
  explicit ThreadTeam(std::size_t members);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  [[nodiscard]] std::size_t members() const { return helpers_.size() + 1; }

  /// Whether the team is this caller's until `give_back`; false where another thread has it.
  bool take() noexcept { return !taken_.exchange(true, std::memory_order_acquire); }
  void give_back() noexcept { taken_.store(false, std::memory_order_release); }
  /// Calls `work(k)` of each member k at once, 0 on this thread, and comes back when all have. Of who has the team.
  template <class Work>
  void run(const Work& work) noexcept {
    begin([](const void* given, std::size_t member) noexcept { (*static_cast<const Work*>(given))(member); }, &work);
    work(0);
    wait();
  }

 private:
  using Call = void (*)(const void* work, std::size_t member) noexcept;
  void begin(Call call, const void* work) noexcept;
  void wait() noexcept;
  void help(std::size_t member) noexcept;
  void end() noexcept;

  Call call_ = nullptr;  ///< null: the helpers end
  const void* work_ = nullptr;
  unsigned arithmetic_ = 0;                          ///< MXCSR of the caller
  alignas(64) std::atomic<std::uint32_t> begun_{0};  ///< pieces of work
  alignas(64) std::atomic<std::uint32_t> done_{0};   ///< helpers that have done the last
  std::atomic<std::uint32_t> asleep_{0};             ///< helpers
  std::atomic<bool> taken_{false};
  std::vector<std::thread> helpers_;
};

}  // namespace withy::sweep
