/// \file
/// The processor's floating-point control state, which any call of a plugin can change for all that follows.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace withy {

/// The control state of a thread. (On x86 the SSE and x87 control words: rounding, flush-to-zero, denormals-are-zero,
/// exception masks, precision. On ARM the FPCR. Elsewhere the rounding mode.)
struct FloatingPointControl {
  std::uint64_t main = 0;  ///< MXCSR without its flags, FPCR, or the rounding mode
  std::uint64_t x87 = 0;
};

/// Saves the calling thread's control state; `restore` brings it back.
class FloatingPointGuard {
 public:
  FloatingPointGuard();
  ~FloatingPointGuard() { restore(); }
  FloatingPointGuard(const FloatingPointGuard&) = delete;
  FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

  /// Restores the state and says what had become of it since, as "flush-to-zero"; empty where nothing had.
  std::string restore();
  /// Whether another state is there now.
  [[nodiscard]] bool changed() const;
  /// As `restore`, where a change is an error. \throws PluginError "`who` changes the rounding mode for the whole
  /// program"
  void check(std::string_view who);

 private:
  FloatingPointControl saved_;
};

/// Remembers that the calling thread's arithmetic was another than it should be during an evaluation, which has
/// restored it since. `changed`: bits of MXCSR.
void note_changed_arithmetic(unsigned changed) noexcept;
/// Whether that was noted since the last call of take_changed_arithmetic; mostly not.
bool has_changed_arithmetic() noexcept;
/// What was noted since the last call, as "the rounding mode"; empty where nothing was.
std::string take_changed_arithmetic();

}  // namespace withy
