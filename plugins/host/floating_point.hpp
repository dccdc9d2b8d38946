/// \file
/// The processor's floating-point control state, which a library can change for the whole program by being loaded.
#pragma once

#include <cstdint>
#include <string>

namespace withy {

/// Saves the calling thread's control state; `restore` brings it back. (On x86 the SSE and x87 control words: rounding,
/// flush-to-zero, denormals-are-zero, exception masks, precision. On ARM the FPCR. Elsewhere the rounding mode.)
class FloatingPointGuard {
 public:
  FloatingPointGuard();
  ~FloatingPointGuard() { restore(); }
  FloatingPointGuard(const FloatingPointGuard&) = delete;
  FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

  /// Restores the state and says what had become of it since, as "flush-to-zero"; empty where nothing had.
  std::string restore();

 private:
  struct Control {
    std::uint64_t main = 0;  ///< MXCSR without its flags, FPCR, or the rounding mode
    std::uint64_t x87 = 0;
  };
  static Control read();
  static void write(const Control& control);
  Control saved_;
};

}  // namespace withy
