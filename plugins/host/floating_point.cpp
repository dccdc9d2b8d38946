#include "withy/plugins/host/floating_point.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace withy {
namespace {

struct Field {
  std::uint64_t bits;
  const char* meaning;
};

#if defined(__SSE2__)
constexpr std::uint64_t sse_flags = 0x3f;  // sticky flags of past operations: no control
constexpr Field fields[] = {{0x8000, "flush-to-zero"},
                            {0x0040, "denormals-are-zero"},
                            {0x6000, "the rounding mode"},
                            {0x1f80, "the floating-point exceptions that trap"}};
#elif defined(__aarch64__)
constexpr Field fields[] = {{0x1000000, "flush-to-zero"},
                            {0x0c00000, "the rounding mode"},
                            {0x0009f00, "the floating-point exceptions that trap"}};
#else
constexpr Field fields[] = {{~std::uint64_t{0}, "the rounding mode"}};
#endif

}  // namespace

FloatingPointGuard::Control FloatingPointGuard::read() {
  Control c;
#if defined(__SSE2__)
  c.main = _mm_getcsr() & ~sse_flags;
  std::uint16_t word = 0;
  asm volatile("fnstcw %0" : "=m"(word));
  c.x87 = word;
#elif defined(__aarch64__)
  asm volatile("mrs %0, fpcr" : "=r"(c.main));
#else
  c.main = static_cast<std::uint64_t>(std::fegetround());
#endif
  return c;
}

void FloatingPointGuard::write(const Control& control) {
#if defined(__SSE2__)
  _mm_setcsr(static_cast<unsigned>(control.main | (_mm_getcsr() & sse_flags)));
  const auto word = static_cast<std::uint16_t>(control.x87);
  asm volatile("fldcw %0" : : "m"(word));
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" : : "r"(control.main));
#else
  std::fesetround(static_cast<int>(control.main));
#endif
}

FloatingPointGuard::FloatingPointGuard() : saved_(read()) {}

std::string FloatingPointGuard::restore() {
  const Control now = read();
  if (now.main == saved_.main && now.x87 == saved_.x87) return {};
  write(saved_);
  std::string text;
  const auto add = [&](const char* what) { text += (text.empty() ? "" : ", ") + std::string(what); };
  for (const Field& field : fields) {
    if (((now.main ^ saved_.main) & field.bits) != 0) add(field.meaning);
  }
  if (now.x87 != saved_.x87) add("the x87 control word");
  return text;
}

}  // namespace withy
