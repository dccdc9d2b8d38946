#include "withy/core/plugin/floating_point.hpp"

#include <utility>

#include "withy/core/plugin/registry.hpp"

#if !defined(__SSE2__) && !defined(__aarch64__)
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

/// Names of the fields that hold any of these bits.
std::string meaning_of(std::uint64_t bits) {
  std::string text;
  for (const Field& field : fields)
    if ((bits & field.bits) != 0) text += (text.empty() ? "" : ", ") + std::string(field.meaning);
  return text;
}

FloatingPointControl read() {
  FloatingPointControl c;
#if defined(__SSE2__)
  c.main = __builtin_ia32_stmxcsr() & ~sse_flags;
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

void write(const FloatingPointControl& control) {
#if defined(__SSE2__)
  __builtin_ia32_ldmxcsr(static_cast<unsigned>(control.main | (__builtin_ia32_stmxcsr() & sse_flags)));
  const auto word = static_cast<std::uint16_t>(control.x87);
  asm volatile("fldcw %0" : : "m"(word));
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" : : "r"(control.main));
#else
  std::fesetround(static_cast<int>(control.main));
#endif
}

thread_local unsigned changed_arithmetic = 0;

}  // namespace

FloatingPointGuard::FloatingPointGuard() : saved_(read()) {}

bool FloatingPointGuard::changed() const {
  const FloatingPointControl now = read();
  return now.main != saved_.main || now.x87 != saved_.x87;
}

std::string FloatingPointGuard::restore() {
  if (!changed()) return {};
  const FloatingPointControl now = read();
  write(saved_);
  std::string text = meaning_of(now.main ^ saved_.main);
  if (now.x87 != saved_.x87) text += (text.empty() ? "" : ", ") + std::string("the x87 control word");
  return text;
}

void FloatingPointGuard::check(std::string_view who) {
  if (changed())
    throw PluginError(std::string(who) + " changes " + restore() + " for the whole program: no result can be trusted");
}

void note_changed_arithmetic(unsigned changed) noexcept { changed_arithmetic |= changed; }

bool has_changed_arithmetic() noexcept { return changed_arithmetic != 0; }

std::string take_changed_arithmetic() { return meaning_of(std::exchange(changed_arithmetic, 0)); }

}  // namespace withy
