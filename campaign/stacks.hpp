/// \file
/// Stacks on which the cases of one thread run in turns.
#pragma once

#include <sys/mman.h>

#include <array>
#include <boost/context/fiber.hpp>
#include <boost/context/stack_context.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "withy/core/equations/lane_equations.hpp"

namespace withy::campaign {

/// Memory of stacks, with a page below that ends the process where one is too small. What a case has left the next one
/// takes: its pages are there already.
class StackPool {
 public:
  StackPool() = default;
  ~StackPool() {
    for (const boost::context::stack_context& stack : vacant_)
      munmap(static_cast<std::byte*>(stack.sp) - stack.size, bytes);
  }
  StackPool(const StackPool&) = delete;
  StackPool& operator=(const StackPool&) = delete;

  boost::context::stack_context take() {
    if (!vacant_.empty()) {
      const boost::context::stack_context stack = vacant_.back();
      vacant_.pop_back();
      return stack;
    }
    vacant_.reserve(most_lanes);  // so that giving back throws nothing
    void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    mprotect(memory, guard, PROT_NONE);
    boost::context::stack_context stack;
    // Not all at the same place in their pages: the nearest cache has room for few lines that are.
    stack.size = bytes - made_++ % apart * (page / apart);
    stack.sp = static_cast<std::byte*>(memory) + stack.size;
    return stack;
  }
  /// At most as many as there are lanes.
  void give_back(const boost::context::stack_context& stack) noexcept { vacant_.push_back(stack); }

 private:
  /// A run uses some kilobytes; pages that are not touched cost nothing.
  static constexpr std::size_t guard = 1 << 14, bytes = 1 << 20, page = 1 << 12, apart = most_lanes;
  std::size_t made_ = 0;
  std::vector<boost::context::stack_context> vacant_;
};

/// The pool as Boost asks for memory.
struct StackMemory {
  StackPool* pool;
  boost::context::stack_context allocate() const { return pool->take(); }
  void deallocate(const boost::context::stack_context& stack) const noexcept { pool->give_back(stack); }
};

/// Stacks that hand the thread to each other: one of the thread's own and one of each lane.
class Stacks {
 public:
  static constexpr std::size_t thread = most_lanes;  ///< index of the thread's own
  /// Begins a stack; its function returns to the thread's own.
  void begin(std::size_t stack, std::function<void()> function) {
    stacks_[stack] = boost::context::fiber(std::allocator_arg, StackMemory{&pool_},
                                           [this, stack, function = std::move(function)](boost::context::fiber&& last) {
                                             stacks_[from_] = std::move(last);
                                             function();
                                             from_ = stack;
                                             return std::move(stacks_[thread]);
                                           });
  }
  [[nodiscard]] bool ended(std::size_t stack) const { return !stacks_[stack]; }
  /// Leaves `own`, on which this runs, for another, until somebody switches back.
  void go_to(std::size_t own, std::size_t other) {
    from_ = own;
    boost::context::fiber last = std::move(stacks_[other]).resume();
    stacks_[from_] = std::move(last);
  }

 private:
  StackPool pool_;  ///< outlives the stacks
  std::array<boost::context::fiber, thread + 1> stacks_;
  std::size_t from_ = thread;  ///< the stack that has just been left
};

}  // namespace withy::campaign
