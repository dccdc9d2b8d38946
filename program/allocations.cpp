#include "withy/program/allocations.hpp"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

// Eigen allocates through malloc, so counting operator new would miss it. The functions below stand in for those of the
// C library in the whole process and hand every call on to it; under the address sanitizer, which has its own, they are
// reported by its hooks.

namespace {
std::atomic<std::size_t> count{0};
}

#if defined(__SANITIZE_ADDRESS__)

#include <sanitizer/allocator_interface.h>

namespace {
void count_allocation(const volatile void*, std::size_t) { count.fetch_add(1, std::memory_order_relaxed); }
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
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

__attribute__((visibility("default"))) void* calloc(std::size_t number, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(number, size);
}

__attribute__((visibility("default"))) void* realloc(void* old, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(old, size);
}

__attribute__((visibility("default"))) void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_memalign(alignment, size);
}

__attribute__((visibility("default"))) int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  void* const memory = __libc_memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *out = memory;
  return 0;
}

}  // extern "C"

#endif

namespace withy::program {

std::size_t allocations() { return count.load(std::memory_order_relaxed); }

void keep_freed_memory() {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
  constexpr int megabyte = 1 << 20;
  ::mallopt(M_TRIM_THRESHOLD, 8 * megabyte);
  ::mallopt(M_MMAP_THRESHOLD, megabyte);  // larger ones come and go by themselves
#endif
}

}  // namespace withy::program
