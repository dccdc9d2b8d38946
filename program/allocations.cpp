#include "withy/program/allocations.hpp"

#include <malloc.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>

// Eigen allocates through malloc, so counting operator new would miss it. The functions below stand in for those of the
// C library in the whole process and hand every call on to it; under the address sanitizer, which has its own, they are
// reported by its hooks.

namespace {

/// The count of some threads, mostly of one. Allocating threads must not wait for each other's cache lines.
struct alignas(64) Count {
  std::atomic<std::size_t> number{0};
};
constexpr std::size_t most_counts = 64;
std::array<Count, most_counts> counts;
std::atomic<std::size_t> threads{0};

/// A locked addition costs as much as the allocation itself. Where more threads have been than there are counts, two
/// that allocate at the same moment may count once.
inline void count_one() noexcept {
  static thread_local std::atomic<std::size_t>* own = nullptr;
  if (own == nullptr) own = &counts[threads.fetch_add(1, std::memory_order_relaxed) % most_counts].number;
  own->store(own->load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)

#include <sanitizer/allocator_interface.h>

namespace {
void count_allocation(const volatile void*, std::size_t) { count_one(); }
void ignore_release(const volatile void*) {}
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(count_allocation, ignore_release);
}  // namespace

#else

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

__attribute__((visibility("default"))) void* malloc(std::size_t size) {
  count_one();
  return __libc_malloc(size);
}

__attribute__((visibility("default"))) void* calloc(std::size_t number, std::size_t size) {
  count_one();
  return __libc_calloc(number, size);
}

__attribute__((visibility("default"))) void* realloc(void* old, std::size_t size) {
  count_one();
  return __libc_realloc(old, size);
}

__attribute__((visibility("default"))) void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_one();
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count_one();
  void* const memory = __libc_memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *out = memory;
  return 0;
}

}  // extern "C"

#endif

namespace withy::program {

std::size_t allocations() {
  std::size_t sum = 0;
  for (const Count& count : counts) sum += count.number.load(std::memory_order_relaxed);
  return sum;
}

void keep_freed_memory() {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
  constexpr int megabyte = 1 << 20;
  ::mallopt(M_TRIM_THRESHOLD, 8 * megabyte);
  ::mallopt(M_MXFAST, 0);                 // else each larger request joins all that wait to be joined
  ::mallopt(M_MMAP_THRESHOLD, megabyte);  // larger ones come and go by themselves
#endif
}

}  // namespace withy::program
